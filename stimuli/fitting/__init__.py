"""Development side of the gait model: reads captures and tables, fits, writes coefficients. Not used at run time."""
