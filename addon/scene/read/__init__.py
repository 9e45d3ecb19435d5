"""Blender → plain data: the only place where the pipeline reads a scene."""
