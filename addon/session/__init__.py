"""State of this Blender session, known by the session uid of its object. Never saved."""
