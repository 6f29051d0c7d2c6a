"""What compares ways of making walks: tables, analysis of variance and figures of their errors."""
