"""Pictures of an analysis for papers and reports, drawn by matplotlib. No Blender here."""
