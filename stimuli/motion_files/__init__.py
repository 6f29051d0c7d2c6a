"""Readers of captured motion; each returns a `stimuli.clip.Clip` in metres, Y up."""
