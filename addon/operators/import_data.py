# SPDX-License-Identifier: GPL-3.0-or-later
"""File → Import → Stormfield Data: wind, currents, flow on surfaces and λ caches as objects with a field."""

from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.props import FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bake.given import GivenField, given_steps
from ..cache.field_cache import FieldCache, open_cache
from ..cache.layout import MANIFEST
from ..model.errors import InputError, MissingPackageError
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from ..readers import Choice, FieldData, SceneScale, series_steps
from ..readers.coasts import Boundary
from ..scene.read import folders
from ..scene.write import attach, imported
from ..scene.write.lambda_keys import key_lambda_over_scene
from ..session import running
from ..work import Step, Steps, scaled
from . import requirements
from .job_operator import JobOperator

#: Part of the steps in which the file is read.
READ = 0.4
ENDINGS = (
    ".nc",
    ".nc4",
    ".grib",
    ".grb",
    ".grib2",
    ".npz",
    ".ply",
    ".vtp",
    ".vtu",
    ".vtk",
    ".pvd",
    ".obj",
    ".t",
    ".usdc",
)


class STORMFIELD_OT_import_data(JobOperator, bpy.types.Operator, ImportHelper):
    """Import wind, currents, flow on a surface, or a λ cache: a mesh with its field, λ keyed over frames. Esc stops"""

    bl_idname = "stormfield.import_data"
    bl_label = "Import Stormfield Data"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Importing"

    filename_ext = ".nc"
    filter_glob: StringProperty(
        default=";".join(f"*{ending}" for ending in (*ENDINGS, ".usda", ".json")), options={"HIDDEN"}
    )
    vector: StringProperty(
        name="Vector",
        description="Array that is the field, or its components with commas between. Empty takes the likely one",
    )
    level: StringProperty(name="Level", description="Level of a grid, such as 850, in its own unit")
    member: StringProperty(name="Member", description="Member of an ensemble on a grid")
    first: StringProperty(
        name="From", description="First time of a grid: a date such as 2018-10-07T06, or a number of the file"
    )
    last: StringProperty(name="To", description="Last time of a grid")
    sphere_faces: IntProperty(
        name="Sphere Faces",
        description="Faces of the sphere that carries a grid of the whole globe, about; 0 follows the grid",
        default=0,
        min=0,
    )
    radius: FloatProperty(
        name="Radius",
        description="Radius of the globe in the scene (mesh units)",
        default=1.0,
        min=1e-3,
        subtype="DISTANCE",
    )

    @classmethod
    def poll(cls, context):
        job = running.current()
        reason = requirements.problem()
        if context.mode != "OBJECT":
            reason = "Leave Edit Mode first"
        elif job is not None:
            reason = f"{job.title} '{job.object_name}'; press Esc to stop it"
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context, event):
        return self.ask(ImportHelper.invoke(self, context, event))

    def subject(self, _context):
        """The object is made when all is there, so that work that is stopped leaves nothing."""
        return

    def new_name(self):
        return Path(self.filepath).stem

    def start(self, context, _obj):
        return self._steps_of(Path(bpy.path.abspath(self.filepath)), _seconds(context.scene))

    def was_stopped(self, name):
        self.report({"WARNING"}, f"Importing '{name}' was stopped; nothing was made")
        return {"CANCELLED"}

    def finish(self, context, _obj, made):
        if isinstance(made, FieldCache):
            obj = imported.add_cache_object(context, made)
            attach.attach_lambda(obj, made.folder)
            words = f"'{obj.name}' shows the λ cache in {made.folder}"
        else:
            obj = imported.add_object(context, made.name, made.mesh, made.boundary)
            attach.show_solved(obj, made.folder)
            imported.remember(obj, made.data)
            words = f"{made.data.read.line()}; {made.scale.words}"
        obj.stormfield.enabled = True
        obj.stormfield.solve.solved = ""  # no elements made it
        key_lambda_over_scene(context.scene, obj)
        self.report({"INFO"}, words)

    def _steps_of(self, path, seconds):
        folder = _cache_folder(path)
        if folder is not None:
            yield Step(0.0, "Opening the cache")
            return open_cache(folder)
        choice = self._choice()
        data = yield from scaled(_read(path, choice), 0.0, READ)
        scale = SceneScale.of(data, self.radius, seconds)
        yield Step(READ, "Finding coasts")
        boundary = imported.boundary_of_globe(data)
        name, mesh = imported.free_name(path.stem), imported.scene_mesh(data, scale)
        stat = path.stat()
        origin = {
            "file": path.name,
            "size": stat.st_size,
            "modified": stat.st_mtime_ns,
            "choice": repr(choice),
            "scale": [scale.lengths, scale.speeds],
        }
        vectors = (scale.speeds * values for values in data.vectors)
        given = GivenField(tuple(data.lambdas.tolist()), vectors, origin)
        steps = given_steps(mesh, given, folders.root_of_new(name), Polygons.of_triangles(mesh.triangles))
        return _Imported(name, data, scale, mesh, boundary, (yield from scaled(steps, READ, 1.0)))

    def _choice(self) -> Choice:
        return Choice(
            vector=self.vector or None,
            level=self.level or None,
            member=self.member or None,
            times=(self.first or self.last, self.last or self.first) if self.first or self.last else None,
            sphere_faces=self.sphere_faces or None,
        )


@dataclass(frozen=True, eq=False)
class _Imported:
    """What becomes an object of this name."""

    name: str
    data: FieldData
    scale: SceneScale
    mesh: MeshData
    boundary: Boundary
    folder: Path


def _read(path: Path, choice: Choice) -> Steps[FieldData]:
    try:
        return (yield from series_steps(path, choice))
    except (ImportError, MissingPackageError) as fault:
        package = fault.package if isinstance(fault, MissingPackageError) else fault.name
        raise InputError(
            f"{path}: reading it needs the Python package {package}, which this Blender does not have; make a λ "
            "cache of it outside with: stormfield import FILE --out FOLDER, and import that"
        ) from fault


def _cache_folder(path: Path) -> Path | None:
    """The folder of a λ cache that one of its files, or it itself, names."""
    for folder in (path, path.parent):
        if (folder / MANIFEST).is_file() and (
            path.is_dir() or path.name in (MANIFEST, *(file.name for file in folder.glob("field.usd*")))
        ):
            return folder
    return None


def _seconds(scene: bpy.types.Scene) -> float:
    """Seconds over which the scene runs."""
    frames = max(scene.frame_end - scene.frame_start, 1)
    return frames * scene.render.fps_base / scene.render.fps


CLASSES = (STORMFIELD_OT_import_data,)
