"""Tests, models and intervals of tidy tables: they know columns, and nothing of studies, runs or reports."""
