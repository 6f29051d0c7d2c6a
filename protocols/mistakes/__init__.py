"""Mistakes in a study file that no single value shows, each with its place and the way out."""
