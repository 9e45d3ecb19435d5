"""Plain data → Blender: modifiers, objects, attributes, lists and timeline markers."""
