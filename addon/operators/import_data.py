# SPDX-License-Identifier: GPL-3.0-or-later
"""File → Import → Stormfield Data: wind, currents, flow on surfaces and λ caches as objects with a field."""

from pathlib import Path

import bpy
from bpy.props import FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..bake.given import GivenField, given_steps
from ..cache.field_cache import open_cache
from ..cache.layout import MANIFEST
from ..model.errors import InputError, MissingPackageError
from ..readers import Choice, FieldData, SceneScale, read_series
from ..scene.read import folders
from ..scene.read.mesh import read_mesh, read_polygons
from ..scene.write import attach, imported
from ..scene.write.lambda_keys import key_lambda_over_scene
from ..session import running
from ..work import Step
from . import requirements
from .job_operator import JobOperator
from .shared import report_fault

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
    """Import wind or currents, flow on a surface, or a λ cache: a mesh with its field, λ keyed over the scene"""

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
        return ImportHelper.invoke(self, context, event)

    def execute(self, context):
        try:
            return super().execute(context)
        except (InputError, OSError) as fault:  # the file is read before the work begins
            return report_fault(self, fault)

    def subject(self, context):
        """The new object."""
        path = Path(bpy.path.abspath(self.filepath))
        self._cache = _cache_folder(path)
        if self._cache is not None:
            cache = open_cache(self._cache)
            self._data = None
            return imported.add_cache_object(context, cache)
        self._data = _read(path, self._choice())
        self._scale = SceneScale.of(self._data, self.radius, _seconds(context.scene))
        return imported.add_object(context, path.stem, self._data, self._scale)

    def start(self, _context, obj):
        if self._data is None:
            return _ready(self._cache)
        stat = Path(bpy.path.abspath(self.filepath)).stat()
        origin = {
            "file": Path(self.filepath).name,
            "size": stat.st_size,
            "modified": stat.st_mtime_ns,
            "choice": repr(self._choice()),
            "scale": [self._scale.lengths, self._scale.speeds],
        }
        scaled = (self._scale.speeds * values for values in self._data.vectors)
        given = GivenField(tuple(self._data.lambdas.tolist()), scaled, origin)
        return given_steps(read_mesh(obj), given, folders.cache_root(obj), read_polygons(obj))

    def finish(self, context, obj, folder):
        obj.stormfield.enabled = True
        if self._data is None:
            attach.attach_lambda(obj, folder)
        else:
            attach.show_solved(obj, folder)
        obj.stormfield.solve.solved = ""  # no elements made it
        key_lambda_over_scene(context.scene, obj)
        if self._data is None:
            self.report({"INFO"}, f"'{obj.name}' shows the λ cache in {folder}")
            return
        imported.remember(obj, self._data)
        self.report({"INFO"}, f"{self._data.read.line()}; {self._scale.words}")

    def _choice(self) -> Choice:
        return Choice(
            vector=self.vector or None,
            level=self.level or None,
            member=self.member or None,
            times=(self.first or self.last, self.last or self.first) if self.first or self.last else None,
            sphere_faces=self.sphere_faces or None,
        )


def _read(path: Path, choice: Choice) -> FieldData:
    try:
        return read_series(path, choice)
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


def _ready(folder: Path):
    """Steps of a cache that is there already."""
    yield Step(1.0, "Opening the cache")
    return folder


CLASSES = (STORMFIELD_OT_import_data,)
