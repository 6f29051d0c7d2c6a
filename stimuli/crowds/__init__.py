"""Crowds: who is in one and what they look like, where each walks, and a thousand poses at once."""
