"""Figures of a planned analysis, each with every participant visible."""
