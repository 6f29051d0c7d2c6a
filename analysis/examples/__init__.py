"""Short scripts to copy: one for each study, from a table of trials to the tests it reports."""
