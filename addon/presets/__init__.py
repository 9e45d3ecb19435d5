# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that are ready to solve, bake and render. Each module has ``build(context, ...)``, which returns the mesh."""
