"""What a participant saw, made again from the journal: the scene of every logged frame, its check, and a film of it."""
