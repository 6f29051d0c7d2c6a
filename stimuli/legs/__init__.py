"""Feet and legs: how a foot stands, rolls and swings, the paths of both feet over a cycle, and the knee in between."""
