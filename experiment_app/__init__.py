"""The gaitlab command: windows, drawing, input, the one loop and the journal of a run."""
