# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of an analysis for papers and reports, drawn by matplotlib. No Blender here."""
