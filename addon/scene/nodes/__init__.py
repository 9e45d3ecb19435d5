# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees: the builder, and the trees that are no materials."""
