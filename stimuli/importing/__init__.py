"""From a folder of captured walks to an actor: described, read, measured, checked, arranged. Knows no window."""
