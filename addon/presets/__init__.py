# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that are ready to solve, bake and render."""

from __future__ import annotations

from .storm_merge import build_storm_merge

__all__ = ["build_storm_merge"]
