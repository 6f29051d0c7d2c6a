"""What runs recorded, as tidy tables: journals, trials, the answers in them and the measures made of them."""
