"""Bodies as arrays: those of gaitlab, imported ones, builds, point lights, and motion put on somebody else's."""
