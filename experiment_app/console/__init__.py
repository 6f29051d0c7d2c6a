"""What the experimenter sees and says while a participant works; it reads the journal and never holds up a frame."""
