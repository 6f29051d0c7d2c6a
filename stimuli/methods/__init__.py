"""Ways of making a walk, one module each: every one takes captured cycles and returns a `stimuli.cycle.Cycle`."""
