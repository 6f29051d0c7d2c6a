"""Places a scene can be shown: a desktop window, an off-screen buffer, a video."""
