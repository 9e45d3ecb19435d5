# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches on disk: attributes over λ or over frames, as USD that Blender reads by itself. No Blender here."""
