"""Figures with a limit beside them, measured where they are run; never part of the tests."""
