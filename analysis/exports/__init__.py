"""Recorded runs as data sets others can read: BIDS, Psych-DS, CSV and Parquet, each with a data dictionary.

Everything is made from the journals and the study file each of them holds; the same journals give the same bytes.
"""
