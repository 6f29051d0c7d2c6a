"""Factors to trials: designs, orders with their limits, adaptive placement, and participants' places in them."""
