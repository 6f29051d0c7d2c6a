"""Where the participant looks: samples of an eye tracker, frame by frame, on the body parts of the walker."""
