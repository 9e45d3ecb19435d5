# SPDX-License-Identifier: GPL-3.0-or-later
"""What a solve reads of a scene, in short, and how two such readings differ: whether a field is out of date.

    before = read(obj)                  # when the solve begins; plain JSON values, kept with the object
    changes(before, read(obj))          # ["the mesh was changed", "'Storm' was moved"]; empty while all is the same

Nothing is evaluated and nothing is written, so that panels and draw handlers may ask. Every setting of the elements and
of the solve counts by itself, also one that is added later; session/freshness.py keeps the answer until Blender reports
a change.
"""

import bpy
import numpy as np
from mathutils import Matrix

from ...model.words import Json
from .edits import facts
from .facts import all_keys, digest, element_keys, keys_of, names_of, shape_of, values_of
from .mesh import corner_vertices

#: Form of what is read; another number makes earlier readings unknown.
FORM = 1
#: What was read of no edits, and of a field that an earlier version has solved.
NO_EDITS: list[str] = []
MESH_CHANGED = "the mesh was changed"
#: Places that differ by less, over the object's diagonal, are the same: round-off of matrices.
SAME_PLACE = 1e-5


def read(obj: bpy.types.Object, mesh: str | None = None) -> dict[str, Json]:
    """mesh, settings: digests; elements: one entry for each that is turned on. mesh: its digest where it is known."""
    elements = [element for element in obj.stormfield.elements if element.enabled]
    entries = [element_entry(obj, element) for element in elements]
    strokes = [entry for entry, element in zip(entries, elements, strict=True) if element.type == "brush"]
    return {
        "names": names_digest(obj),
        "mesh": mesh or mesh_digest(obj.data),
        "settings": settings_digest(obj),
        "size": max(obj.dimensions[:]),
        "elements": entries,
        "strokes": [f"{entry['settings']} {entry['shape']}" for entry in strokes],
        "edits": edits_digests(obj),
    }


def edits_digests(obj: bpy.types.Object) -> list[str]:
    """Of the edits that are turned on, in their order."""
    return [digest(*facts(obj, number)) for number, edit in enumerate(obj.stormfield.edits) if edit.enabled]


def changes(before: dict[str, Json], now: dict[str, Json]) -> list[str]:
    """What has changed, in words; empty when a solve would find the same scene, and where another version of the
    add-on, with other settings, has read it before."""
    if before.get("names") != now["names"]:
        return []
    found = []
    if before["mesh"] != now["mesh"]:
        found.append(MESH_CHANGED)
    if before["settings"] != now["settings"]:
        found.append("settings were changed")
    left = list(before["elements"])
    slack = SAME_PLACE * max(float(now["size"]), 1e-9)
    changed = []
    for element in now["elements"]:
        same = next((old for old in left if _same(old, element, slack)), None)
        if same is None:
            changed.append(element)
        else:
            left.remove(same)
    known = {old["name"]: old for old in left}
    for element in changed:
        old = known.pop(element["name"], None)
        found.append(f"'{element['name']}' was {_how(old, element)}")
    found += [f"'{name}' was removed or turned off" for name in known]
    if not found and before.get("strokes", NO_EDITS) != now["strokes"]:
        found.append("brush strokes were put in another order")
    if before.get("edits", NO_EDITS) != now["edits"]:
        found.append("edits were changed")
    return found


def mesh_digest(mesh: bpy.types.Mesh) -> str:
    """Of vertices and corners, as Object Mode has them."""
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    return digest([len(mesh.polygons)], vertices, corner_vertices(mesh))


def names_digest(obj: bpy.types.Object) -> str:
    """Of the names of all settings."""
    elements = obj.stormfield.bl_rna.properties["elements"].fixed_type
    return digest(FORM, names_of(obj.stormfield.solve), tuple(sorted(elements.properties.keys())))


def settings_digest(obj: bpy.types.Object) -> str:
    return digest(values_of(obj.stormfield.solve))


def _how(old, element) -> str:
    if old is None:
        return "added or turned on"
    if old["settings"] != element["settings"]:
        return "changed"
    return "drawn anew" if old["shape"] != element["shape"] else "moved"


def _same(old, new, slack: float) -> bool:
    if (old["settings"], old["shape"], len(old["place"])) != (new["settings"], new["shape"], len(new["place"])):
        return False
    return bool(np.allclose(old["place"], new["place"], rtol=0.0, atol=slack))


def element_entry(obj: bpy.types.Object, element) -> dict[str, Json]:
    """settings, shape: digests; place: numbers of the matrix from the source to the mesh, where nothing moves it."""
    source = element.source
    animated = list(element_keys(obj, element))
    held = values_of(element, frozenset(name for name, _ in animated))  # the others follow from their keys
    settings = digest(held, *animated, *keys_of(obj)) if animated else digest(held)
    entry: dict[str, Json] = {"name": element.name, "settings": settings}
    if source is None:
        return {**entry, "shape": "", "place": []}
    keys = list(all_keys(source))
    if keys:  # where it is follows from its keys, and no frame is another's change
        return {**entry, "shape": digest(*shape_of(source), *keys, *keys_of(obj)), "place": []}
    place = np.array(_world(obj).inverted_safe() @ _world(source))[:3]
    return {**entry, "shape": digest(*shape_of(source)), "place": place.ravel().tolist()}


def _world(obj: bpy.types.Object) -> Matrix:
    """Where an object is. What the window does not show is not evaluated: its parents and its own channels say it."""
    if obj.visible_get():
        return obj.matrix_world
    if obj.parent is None or obj.parent_type != "OBJECT":
        return obj.matrix_basis
    return _world(obj.parent) @ obj.matrix_parent_inverse @ obj.matrix_basis
