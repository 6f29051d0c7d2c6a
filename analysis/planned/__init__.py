"""The analysis a study file plans: what it asks for, and what was found."""
