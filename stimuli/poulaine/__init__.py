"""The poulaine, or ankle cyclogram: the ankle's path seen from the hip, taken apart, rebuilt, edited and walked."""
