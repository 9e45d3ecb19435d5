"""Panels, the Add menu entry and the viewport overlay."""

import bpy

from . import lists, menus, overlay, panels

CLASSES = (*lists.CLASSES, *menus.CLASSES, *panels.CLASSES)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_add.append(menus.draw_add_menu)
    overlay.register()


def unregister() -> None:
    overlay.unregister()
    bpy.types.VIEW3D_MT_add.remove(menus.draw_add_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
