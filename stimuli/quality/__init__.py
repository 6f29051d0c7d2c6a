"""How well an actor walks: delivered gait over its coverage, and joint angles against healthy adults."""
