"""From a design to files that renders read without Python: the λ cache, the frame cache, EXR flow maps, VDB bands."""
