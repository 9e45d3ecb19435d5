# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that the user can correct. Messages are shown as they are: they name the element or file, and the cure."""


class InputError(ValueError):
    """The user's data or files cannot be used. Loaded by native.py, the compiled core raises it too."""
