# SPDX-License-Identifier: GPL-3.0-or-later
"""Where caches live: next to the .blend file when it is saved, in Blender's temporary folder until then.

    stormfield_cache / <object> / lambda-0123456789ab

Folders of caches are named by what made them, so files, versions and objects that share one show the same. An object
keeps the name of its folder when it is renamed.
"""

import hashlib
import os
import re
import unicodedata
from pathlib import Path

import bpy

from ...cache.layout import FOLDER_NAME, OLD_FOLDERS
from . import user_preferences

NAME = "stormfield_cache"
#: Bytes of a folder's name: systems take 255, and a key may be added.
LONGEST = 200
#: Names that Windows keeps for devices, with any ending.
RESERVED = re.compile(r"(CON|PRN|AUX|NUL|CONIN\$|CONOUT\$|(COM|LPT)[0-9¹²³])(\..*)?", re.IGNORECASE)


def cache_root(obj: bpy.types.Object, blend: str | None = None) -> Path:
    """The folder of all caches of `obj`, for the open file or for the file name `blend`."""
    return base_folder(obj, blend) / folder_name(obj)


def base_folder(obj: bpy.types.Object, blend: str | None = None) -> Path:
    """The folder in which objects have theirs: the one chosen in the Bake panel, or that of the file."""
    chosen = obj.stormfield.bake.folder
    blend = bpy.data.filepath if blend is None else blend
    if chosen and not (chosen.startswith("//") and not blend):
        return absolute(chosen, str(Path(blend).parent) if blend else None)
    return file_base(blend)


def file_base(blend: str) -> Path:
    """The base folder of a file where nothing else is chosen for an object."""
    everywhere = user_preferences.read().cache_folder
    if not blend:
        return temporary_root()
    return absolute(everywhere) / _file_folder(Path(blend)) if everywhere else Path(blend).parent / NAME


def _file_folder(blend: Path) -> str:
    """A folder for one .blend file among those of all files; two of the same name differ by where they lie."""
    return f"{file_name(blend.stem)}-{hashlib.sha256(str(blend.parent).encode()).hexdigest()[:8]}"


def temporary_root() -> Path:
    return Path(bpy.app.tempdir) / NAME


def absolute(path: str, start: str | None = None, library: bpy.types.Library | None = None) -> Path:
    """A path of Blender's as this system has it, read as Blender itself does: backslashes part folders everywhere, and
    a drive's letter means nothing where there are no drives."""
    path = path.replace("\\", "/")
    if os.name != "nt" and re.match(r"[A-Za-z]:/", path):
        path = path[2:]
    return Path(os.path.normpath(bpy.path.abspath(path, start=start, library=library)))


def relative(path: Path, blend: str) -> str:
    """A path as Blender writes it into the file `blend`: relative to it, where both are on one drive."""
    if not blend or Path(blend).drive != path.drive:
        return str(path)
    return bpy.path.relpath(str(path), start=str(Path(blend).parent))


def folder_name(obj: bpy.types.Object) -> str:
    """The name of an object's folder: the one it has since its first solve, else one that no other object has."""
    if obj.stormfield.cache_name:
        return obj.stormfield.cache_name
    return _free_name(obj.name, [other for other in _with_field() if other != obj])


def root_of_new(name: str) -> Path:
    """The folder of all caches that an object of this name will have, which is not there yet."""
    return file_base(bpy.data.filepath) / _free_name(name, _with_field())


def _with_field() -> list[bpy.types.Object]:
    return [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.stormfield.enabled]


def _free_name(own: str, others: list[bpy.types.Object]) -> str:
    taken = {_alike(other.stormfield.cache_name) for other in others}
    # Blender keeps names apart that differ in capitals; not every file system does.
    if any(_alike(other.name) == _alike(own) and other.name < own for other in others):
        taken.add(_alike(file_name(own)))
    return next(name for name in _names(own) if _alike(name) not in taken)


def file_name(name: str) -> str:
    """An object's name as a folder's name on every system. Names that had to be changed carry a key of the whole."""
    cleaned = re.sub(r'[\\/:*?"<>|\x00-\x1f\x7f]', "_", name).strip(" .")
    cleaned = cleaned.encode()[:LONGEST].decode(errors="ignore")
    if cleaned == name and not RESERVED.fullmatch(name):
        return name
    return f"{cleaned or 'object'}-{_key(name)}" if not RESERVED.fullmatch(cleaned) else f"_{cleaned}-{_key(name)}"


def cache_folder_of(path: Path) -> Path | None:
    """The folder of the cache that a file belongs to, by the names of its folders; None for all other files."""
    for folder in (path, *path.parents):
        if FOLDER_NAME.fullmatch(folder.name.encode(errors="replace")):
            return folder
        if folder.name in OLD_FOLDERS and folder.parent.parent.name == NAME:
            return folder
    return None


def _names(name: str):
    """The folder's name of an object, and others for those whose name is taken."""
    yield file_name(name)
    number = 2
    while True:
        yield f"{file_name(name)}-{number}"
        number += 1


def _alike(name: str) -> str:
    """Equal for names that some file system takes for one."""
    return unicodedata.normalize("NFC", name).casefold()


def _key(name: str) -> str:
    return hashlib.sha256(name.encode(errors="surrogatepass")).hexdigest()[:8]
