# SPDX-License-Identifier: GPL-3.0-or-later
"""Field from Attribute: vectors that are on the mesh already become its field, still or over frames."""

import hashlib

import bpy
import numpy as np
from bpy.props import BoolProperty, IntProperty, StringProperty

from .. import native
from ..bake.given import GivenField, given_steps
from ..cache.fields import native_mesh
from ..model.errors import InputError
from ..model.manifold import manifold
from ..scene.read import folders
from ..scene.read.attribute_field import at_rest, candidates, names_of, read_vectors
from ..scene.read.mesh import read_mesh, read_polygons
from ..scene.write import attach, doubts
from ..scene.write.lambda_keys import key_lambda
from ..session import running
from ..work import Step, scaled
from . import requirements
from .job_operator import JobOperator

#: Part of the steps in which frames are read.
READ = 0.4
#: Where less than this share of a vector is along the surface nearly everywhere, it is a normal.
NORMAL = 0.01


def why_not(obj: bpy.types.Object) -> str:
    """Why no attribute can become a field now, and the cure; empty when one can."""
    if obj.mode == "EDIT":
        return "Leave Edit Mode first: attributes cannot be read there"
    if not obj.data.polygons:
        return f"'{obj.name}' has no faces; a field needs a surface"
    if not obj.is_editable or obj.library:
        return f"'{obj.name}' is linked from another file; make it local first"
    return requirements.problem()


class STORMFIELD_OT_field_from_attribute(JobOperator, bpy.types.Operator):
    """Make a vector attribute of the mesh its field, as imported or as Geometry Nodes make it. Esc stops"""

    bl_idname = "stormfield.field_from_attribute"
    bl_label = "Field from Attribute"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Reading attributes"
    why_not = staticmethod(why_not)

    attribute: StringProperty(
        name="Attribute",
        description="Vector attribute of points, faces or corners, or three attributes of numbers with commas between; "
        "mesh units per second. Empty takes the only one",
    )
    animated: BoolProperty(
        name="Over the Scene's Frames",
        description="Read what the modifiers make of it at every frame of the scene; λ is keyed over these frames",
        default=False,
    )
    step: IntProperty(name="Every", description="Frames from one λ sample to the next", default=1, min=1, soft_max=10)

    @classmethod
    def poll(cls, context):
        obj, job = context.object, running.current()
        if obj is None or obj.type != "MESH":
            cls.poll_message_set("Select a mesh: its attribute becomes its field")
            return False
        reason = f"{job.title} '{job.object_name}'; press Esc to stop it" if job is not None else why_not(obj)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context, event):
        if bpy.app.background or self.attribute:
            return super().invoke(context, event)
        found = candidates(_seen(context, context.object))
        self.attribute = found[0].name if found else ""
        return self.ask(context.window_manager.invoke_props_dialog(self))

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop_search(self, "attribute", context.object.data, "attributes")
        layout.prop(self, "animated")
        column = layout.column()
        column.enabled = self.animated
        column.prop(self, "step")

    def subject(self, context):
        return context.object

    def start(self, context, obj):
        where = f"'{obj.name}'"
        name = self.attribute or _only(_seen(context, obj), where)
        scene = context.scene
        self._frames = range(scene.frame_start, scene.frame_end + 1, self.step) if self.animated else ()
        if self.animated and len(self._frames) < 2:
            raise InputError("The scene has one frame only; give it more, or read the attribute of this frame")
        return self._steps_of(context, obj, name, where)

    def finish(self, context, obj, folder):
        obj.stormfield.enabled = True
        attach.show_solved(obj, folder)
        obj.stormfield.solve.solved = ""  # no elements made it
        doubts.keep(obj, ())
        if self.animated:
            key_lambda(obj, self._frames[0], self._frames[-1], context.scene.frame_current)
        of = f"over {len(self._frames)} frames" if self.animated else f"of frame {context.scene.frame_current}"
        self.report({"INFO"}, f"'{obj.name}' has {self.attribute or 'its attribute'} {of} as its field")

    def _steps_of(self, context, obj, name, where):
        mesh, polygons = read_mesh(obj), read_polygons(obj)
        vectors = yield from scaled(self._read(context, obj, name, where), 0.0, READ)
        normal = _check(mesh, vectors, name, where)
        count = len(vectors)
        lambdas = tuple(np.linspace(0.0, 1.0, count).tolist()) if count > 1 else (0.0,)
        given = GivenField(lambdas, vectors, {"attribute": name, "digest": _digest(vectors)})
        if normal:
            yield Step(READ, "Reading attributes", notes=(normal,))
        return (yield from scaled(given_steps(mesh, given, folders.cache_root(obj), polygons), READ, 1.0))

    def _read(self, context, obj, name, where):
        """The vectors at the vertices of the mesh at rest, of this frame or of each."""
        if not self.animated:
            yield Step(0.0, "Reading the attribute")
            return [_now(context, obj, name, where)]
        scene, now, found = context.scene, context.scene.frame_current, []
        try:
            for done, frame in enumerate(self._frames):
                scene.frame_set(frame)
                found.append(_now(context, obj, name, where).astype(np.float32))
                yield Step((done + 1) / len(self._frames), f"Reading frame {frame}")
        finally:
            scene.frame_set(now)
        return found


def _seen(context, obj) -> bpy.types.Mesh:
    """The mesh that has most attributes: the evaluated one."""
    return obj.evaluated_get(context.evaluated_depsgraph_get()).data


def _now(context, obj, name: str, where: str) -> np.ndarray:
    seen = _seen(context, obj)
    own = obj.data
    changed = (len(seen.vertices), len(seen.polygons)) != (len(own.vertices), len(own.polygons))
    if changed and all(part in own.attributes for part in names_of(own, name)):
        return read_vectors(own, name, where)
    return at_rest(obj.data, seen, read_vectors(seen, name, where), where)


def _only(mesh: bpy.types.Mesh, where: str) -> str:
    found = candidates(mesh)
    if len(found) == 1:
        return found[0].name
    listed = ", ".join(candidate.words for candidate in found)
    raise InputError(
        f"{where} has {len(found)} attributes that may be a field: {listed}; choose one"
        if found
        else f"{where} has no vector attribute; import one with the mesh, or make it with Geometry Nodes"
    )


def _check(mesh, vectors, name: str, where: str) -> str:
    """What is to be said of the vectors. Raises InputError where they are no field: zero, or normals of the surface."""
    largest = max(float(np.abs(values).max()) for values in vectors)
    if largest == 0.0:
        raise InputError(f"'{name}' of {where} is zero everywhere; choose another attribute")
    surface = manifold(mesh)
    values = max(vectors, key=lambda one: float(np.abs(one).max())).astype(np.float64)
    values = surface.to_surface(values)
    length = np.linalg.norm(values, axis=1)
    there = length > 1e-6 * length.max()
    tangent = native.VectorField.from_space(native_mesh(surface.mesh), values).to_space()
    share = float(np.median(np.linalg.norm(tangent, axis=1)[there] / length[there]))
    if share < NORMAL:
        raise InputError(f"'{name}' of {where} is normal to the surface nearly everywhere: normals, not a field")
    return f"'{name}' is across the surface for the most part: {share:.0%} of it is along it" if share < 0.5 else ""


def _digest(vectors) -> str:
    digest = hashlib.sha256()
    for values in vectors:
        digest.update(np.ascontiguousarray(values, np.float32).tobytes())
    return digest.hexdigest()


CLASSES = (STORMFIELD_OT_field_from_attribute,)
