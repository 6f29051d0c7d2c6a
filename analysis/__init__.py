"""Recorded runs to tidy tables, tests, figures and a report."""
