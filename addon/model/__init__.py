"""Plain data: designs and meshes. No bpy, no native module."""
