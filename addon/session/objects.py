# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects known by their session uid: it stays through renaming, undo and redo, and a duplicate gets its own.

An evaluated object has none: ask its original.
"""

import bpy


def find(uid: int) -> bpy.types.Object | None:
    """The object of that session uid, if it is still in the file."""
    return next((obj for obj in bpy.data.objects if obj.session_uid == uid), None)
