# SPDX-License-Identifier: GPL-3.0-or-later
"""Every place in the open file that names a cache: cache files of modifiers, images and volumes that show flow maps and
bands, and the fields' own record of what they baked."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from ...bake.task import TargetName
from .attached import SORT
from .folders import absolute, cache_folder_of

#: Data-blocks with a path that Blender itself keeps right when a file is saved elsewhere.
BLOCKS = ("cache_files", "images", "volumes", "movieclips")
#: Settings that record where a bake wrote, by target.
RECORDS: dict[TargetName, str] = {"exr": "flow_maps", "vdb": "volumes"}


@dataclass(frozen=True)
class CachePath:
    """One path, as attribute `name` of `holder`; `folder` is the cache it leads into."""

    block: bpy.types.ID
    holder: Any
    name: str
    path: Path
    folder: Path

    @property
    def is_record(self) -> bool:
        """Whether it is a setting of ours, whose path Blender does not keep right."""
        return self.holder != self.block

    @property
    def text(self) -> str:
        return getattr(self.holder, self.name)

    def write(self, text: str) -> None:
        if self.text != text:
            setattr(self.holder, self.name, text)

    def inside(self, folder: Path) -> Path:
        """The same file where the cache is `folder`."""
        return folder / self.path.relative_to(self.folder)


def cache_paths() -> Iterator[CachePath]:
    """All of them that this file may change: not those of linked data-blocks."""
    for collection in BLOCKS:
        for block in getattr(bpy.data, collection):
            if block.library is None and block.filepath:
                path = absolute(block.filepath)
                folder = cache_folder_of(path)
                if folder is None and block.get(SORT) is not None:
                    folder = path.parent
                if folder is not None:
                    yield CachePath(block, block, "filepath", path, folder)
    for obj in fields():
        for name in RECORDS.values():
            text = getattr(obj.stormfield.bake, name)
            if text and obj.library is None:
                path = absolute(text)
                yield CachePath(obj, obj.stormfield.bake, name, path, path)


def fields() -> list[bpy.types.Object]:
    return [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.stormfield.enabled]


def shown_folders() -> set[Path]:
    """Folders of the caches that the open file names."""
    return {found.folder for found in cache_paths()}
