"""Who takes part in a study: arrivals, drop-outs, withdrawals and what was made of their data."""
