"""Node trees: the builder, and the trees that are no materials."""
