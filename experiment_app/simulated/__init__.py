"""Simulated participants: the same trials, loop and journal as real ones."""
