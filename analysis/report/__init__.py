"""The results in words: the page a browser shows, APA sentences, and tables for LaTeX."""
