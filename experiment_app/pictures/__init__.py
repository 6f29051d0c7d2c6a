"""Pictures and films made off-screen: of conditions, of actors, of the gallery."""
