# SPDX-License-Identifier: GPL-3.0-or-later
"""From a solved field to files that renders read without Python: frame cache, EXR flow maps, VDB bands, Morse sets."""
