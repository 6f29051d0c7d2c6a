"""Tasks as pure state machines (adjustment, choice, rating), and what a study file says of each."""
