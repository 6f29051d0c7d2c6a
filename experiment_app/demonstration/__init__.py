"""The demo: a study in a minute, for somebody at the screen or with a simulated participant."""
