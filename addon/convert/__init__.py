"""Blender → plain data: everything the pipeline needs from a scene is read here, once, into frozen dataclasses."""
