"""Power: from an effect size by formula, and by simulating the study's own participants, trials and analysis."""
