# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, the graph editor, the Add menu entry and the viewport overlay."""

import bpy

from . import (
    analysis_panels,
    edit_panels,
    graph_editor,
    icons,
    lists,
    menus,
    morse_panels,
    overlay,
    panels,
    pick,
    pictures,
)

CLASSES = (
    *lists.CLASSES,
    *menus.CLASSES,
    *graph_editor.CLASSES,
    *panels.CLASSES,
    *analysis_panels.CLASSES,
    *edit_panels.CLASSES,
    *morse_panels.CLASSES,
    *analysis_panels.LATER,
    *pick.CLASSES,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_add.append(menus.draw_add_menu)
    bpy.types.TOPBAR_MT_file_import.append(menus.draw_import_menu)
    graph_editor.register()
    overlay.register()


def unregister() -> None:
    overlay.unregister()
    graph_editor.unregister()
    icons.unregister()
    pictures.unregister()
    bpy.types.TOPBAR_MT_file_import.remove(menus.draw_import_menu)
    bpy.types.VIEW3D_MT_add.remove(menus.draw_add_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
