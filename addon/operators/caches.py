# SPDX-License-Identifier: GPL-3.0-or-later
"""Caches on disk: bring to the file what could not be copied when it was saved, and delete what no file names."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, CollectionProperty, StringProperty

from ..cache.store import delete_cache
from ..model.errors import InputError
from ..scene.read.cache_use import CacheUse, cache_uses, is_recent
from ..scene.write import cache_folders
from ..session import made_caches, saves
from .shared import report_fault

UNITS = ("bytes", "kB", "MB", "GB", "TB")


class STORMFIELD_OT_bring_caches(bpy.types.Operator):
    """Copy the caches that this file shows from elsewhere to the folder beside it. Save the file afterwards"""

    bl_idname = "stormfield.bring_caches"
    bl_label = "Bring Caches to the File"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, _context):
        if not bpy.data.filepath:
            cls.poll_message_set("Save the file first: caches lie beside it")
            return False
        return True

    def execute(self, _context):
        saves.begin(cache_folders.bring_along(bpy.data.filepath))
        saves.end()
        if saves.refused():
            return report_fault(self, InputError("; ".join(saves.refused())))
        self.report({"INFO"}, "All caches lie beside the file; save it, so that it finds them there")
        return {"FINISHED"}


class CacheItem(bpy.types.PropertyGroup):
    """One cache in the list of those that may be deleted."""

    path: StringProperty(name="Folder", description="Where the cache lies")
    text: StringProperty(name="Cache", description="Object, cache and size")
    why_kept: StringProperty(name="Use", description="What uses the cache")
    delete: BoolProperty(name="Delete", description="Delete this cache")


class STORMFIELD_OT_clean_caches(bpy.types.Operator):
    """Delete caches that no .blend file names, here, in the folders around or among the autosaves. Undo cannot bring
    them back"""

    bl_idname = "stormfield.clean_caches"
    bl_label = "Clean Up Caches"
    bl_options = {"REGISTER"}

    items: CollectionProperty(type=CacheItem, name="Caches", description="What lies in the cache folder")

    def invoke(self, context, _event):
        self._list()
        if not self.items:
            self.report({"INFO"}, "There are no caches yet")
            return {"CANCELLED"}
        return context.window_manager.invoke_props_dialog(self, width=640, confirm_text="Delete")

    def draw(self, _context):
        column = self.layout.column(align=True)
        for item in self.items:
            row = column.row()
            row.enabled = not item.why_kept
            row.prop(item, "delete", text=item.text)
            row.label(text=item.why_kept or "no file names it")

    def execute(self, _context):
        if not self.items:
            self._list()
        freed, number = 0, 0
        for item in self.items:
            if item.delete:
                folder = Path(item.path)
                freed += sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
                try:
                    delete_cache(folder)
                except InputError as fault:
                    return report_fault(self, fault)
                number += 1
        self.items.clear()
        self.report({"INFO"}, f"{number} caches are deleted, {size(freed)}")
        return {"FINISHED"}

    def _list(self) -> None:
        self.items.clear()
        for use in sorted(cache_uses(), key=lambda use: (bool(use.why_kept), -use.size)):
            item = self.items.add()
            item.path, item.why_kept = str(use.folder), why_kept(use)
            item.text = f"{use.folder.parent.name}  {use.folder.name}  {size(use.size)}"
            item.delete = not item.why_kept


def why_kept(use: CacheUse) -> str:
    """Why a cache is not to be deleted; empty where it is of no use any more."""
    if not use.why_kept and is_recent(use) and not made_caches.is_made_here(use.folder):
        return "new: another Blender may show it"
    return use.why_kept


def size(count: int) -> str:
    """A number of bytes in words."""
    number, unit = float(count), 0
    while number >= 1000.0 and unit < len(UNITS) - 1:
        number, unit = number / 1000.0, unit + 1
    return f"{number:.3g} {UNITS[unit]}"


CLASSES = (CacheItem, STORMFIELD_OT_bring_caches, STORMFIELD_OT_clean_caches)
