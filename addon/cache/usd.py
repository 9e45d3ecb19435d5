# SPDX-License-Identifier: GPL-3.0-or-later
"""USD files of a field cache.

Layout of a cache (names relative to its folder; the λ cache, the frame cache in brackets):

    samples/lam_0000.usdc     one time sample of every attribute, as primvars   [frames/frame_0001.usdc]
    field.usdc                /stormfield/mesh: points, the artist's own polygons and all samples; open this one

The samples are what machines write in any order; field.usdc takes them in, and then their own files are removed. It
names no other file, so whoever packs or moves what a .blend file names (Blender itself, farms) has the whole field.

Time codes are λ · 1000 [the frame]; between samples USD interpolates linearly. Integers belong to polygons and keep
the value of the sample before; everything else belongs to vertices.

Attaching a cache to the artist's object in Blender (4.5 and 5.2; tests/python/test_bake_blender.py does exactly this):

    bpy.ops.cachefile.open(filepath=str(folder / "field.usdc"))              # cache_file: the new one in
    cache_file = ...                                                         # bpy.data.cache_files, found by difference
    modifier = object.modifiers.new("Stormfield", "MESH_SEQUENCE_CACHE")     # before every other modifier
    modifier.cache_file = cache_file
    modifier.object_path = "/stormfield/mesh"
    modifier.read_data = {"ATTRIBUTES"}
    λ cache:      cache_file.override_frame = True, and a driver on cache_file.frame: λ · 1000
                  (a plain expression such as "lam * 1000" runs without the permission to run scripts)
    frame cache:  cache_file.override_frame = False (it follows the scene's frame)
    after a new bake into the same folder: cache_file.filepath = cache_file.filepath (rereads the file)

Two modifiers with two cache files may follow each other. Blender takes the attributes onto the object's own mesh only
while the counts of vertices, polygons and corners are those of the cached mesh; else it replaces the mesh. Write the
artist's polygons, therefore, not their triangles: MeshData alone does not know them, `Polygons` does.
"""

import errno
import os
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..model.errors import InputError
from ..model.mesh_data import MeshData
from ..model.polygons import Polygons
from .bundled import bundled
from .layout import PRIM, ROOT, TIME_CODES_PER_SECOND

Attributes = Mapping[str, np.ndarray]

#: Bytes of samples that are held in memory before they are written.
BUFFER = 64 << 20


@cache
def usd() -> SimpleNamespace:
    """The modules of pxr: Blender's own, or usd-core's where there is no Blender."""
    bundled("pxr")
    from pxr import Sdf, Tf, Usd, UsdGeom, Vt

    return SimpleNamespace(Sdf=Sdf, Tf=Tf, Usd=Usd, UsdGeom=UsdGeom, Vt=Vt)


def write_sample(path: Path, time_code: float, attributes: Attributes) -> None:
    """One time sample of every attribute: float32 (n, 3) or (n,) per vertex, int32 (f,) per polygon. Equal input gives
    equal bytes."""
    pxr = usd()
    layer, stage = _new_stage(".usdc")
    _set(pxr.UsdGeom.PrimvarsAPI(stage.OverridePrim(PRIM)), time_code, attributes)
    _export(layer, path)


def read_sample(path: Path, time_code: float | None = None) -> dict[str, np.ndarray]:
    """The attributes at one of the time codes of a file, bit for bit; None: of a file with one sample."""
    stage = _open(path)
    attributes: dict[str, np.ndarray] = {}
    for name, primvar in _sampled(stage).items():
        found = primvar.Get(primvar.GetTimeSamples()[0] if time_code is None else time_code)
        attributes[name] = np.array(found, _number(primvar))
    return attributes


def read_values(path: Path, name: str, time_codes: Sequence[float]) -> np.ndarray:
    """One attribute at all time codes, (s, ...). Raises KeyError where there is no such attribute."""
    stage = _open(path)
    primvar = _sampled(stage)[name]
    return np.stack([np.array(primvar.Get(time_code), _number(primvar)) for time_code in time_codes])


def write_stage(
    path: Path,
    mesh: MeshData,
    polygons: Polygons | None,
    time_codes: Sequence[float],
    samples: Iterable[Attributes | None],
) -> Generator[float]:
    """STAGE: the mesh, and its samples at increasing time codes; None for one that is not there yet. Yields the
    fraction that is written. Memory holds few samples at a time; equal input gives equal bytes."""
    pxr = usd()
    with _system_errors(path):
        layer = pxr.Sdf.Layer.CreateNew(str(path))
        stage = pxr.Usd.Stage.Open(layer)
        pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.z)
        pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(TIME_CODES_PER_SECOND)
        stage.SetStartTimeCode(time_codes[0])
        stage.SetEndTimeCode(time_codes[-1])
        stage.SetDefaultPrim(stage.DefinePrim(ROOT, "Scope"))
        primvars = pxr.UsdGeom.PrimvarsAPI(_define_mesh(stage, mesh, polygons))
        held, waiting = 0, list(reversed(time_codes))
        for attributes in samples:
            if attributes is not None:
                _set(primvars, waiting.pop(), attributes)
                held += sum(values.nbytes for values in attributes.values())
            if held >= BUFFER:
                layer.Save()
                held = 0
            yield 1.0 - len(waiting) / len(time_codes)
        if waiting:
            raise ValueError(f"{len(waiting)} of {len(time_codes)} samples are missing")
        layer.Save()


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) float64 and triangles (m, 3) int32, bit for bit."""
    stage = _open(path)
    prim = stage.GetPrimAtPath(PRIM)
    exact = prim.GetAttribute("stormfield:vertices").Get()
    points = exact if exact is not None else prim.GetAttribute("points").Get()
    triangles = prim.GetAttribute("stormfield:triangles").Get()
    return np.array(points, np.float64).reshape(-1, 3), np.array(triangles, np.int32).reshape(-1, 3)


# Steps ----------------------------------------------------------------------------------------------------------------


def per_polygon(values: np.ndarray) -> bool:
    """Whether an attribute has a value for each polygon, and not for each vertex: integers do."""
    return values.dtype.kind == "i"


def _sampled(stage) -> dict[str, Any]:
    """The primvars that have time samples, by name. They live as long as the stage."""
    primvars = usd().UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(PRIM)).GetPrimvars()
    return {primvar.GetPrimvarName(): primvar for primvar in primvars if primvar.GetAttr().GetNumTimeSamples()}


def _number(primvar) -> type:
    return np.int32 if primvar.GetTypeName() == usd().Sdf.ValueTypeNames.IntArray else np.float32


def _define_mesh(stage, mesh: MeshData, polygons: Polygons | None):
    """The prim of a mesh. Vertices that float32 cannot hold are kept in double, in an attribute of their own."""
    pxr = usd()
    geometry = pxr.UsdGeom.Mesh.Define(stage, PRIM)
    points = np.ascontiguousarray(mesh.vertices, np.float32)
    faces = polygons or Polygons.of_triangles(mesh.triangles)
    geometry.CreatePointsAttr(pxr.Vt.Vec3fArray.FromNumpy(points))
    geometry.CreateFaceVertexCountsAttr(pxr.Vt.IntArray.FromNumpy(np.ascontiguousarray(faces.counts, np.int32)))
    geometry.CreateFaceVertexIndicesAttr(pxr.Vt.IntArray.FromNumpy(np.ascontiguousarray(faces.indices, np.int32)))
    geometry.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
    prim, names = geometry.GetPrim(), pxr.Sdf.ValueTypeNames
    corners = np.ascontiguousarray(mesh.triangles, np.int32)
    prim.CreateAttribute("stormfield:triangles", names.Int3Array).Set(pxr.Vt.Vec3iArray.FromNumpy(corners))
    if not np.array_equal(points.astype(np.float64), mesh.vertices):
        exact = np.ascontiguousarray(mesh.vertices, np.float64)
        prim.CreateAttribute("stormfield:vertices", names.Double3Array).Set(pxr.Vt.Vec3dArray.FromNumpy(exact))
    return prim


def _set(primvars, time_code: float, attributes: Attributes) -> None:
    """One time sample of every attribute, declared where it is the first."""
    vt = usd().Vt
    for name, values in sorted(attributes.items()):
        primvar = primvars.GetPrimvar(name)
        if not primvar:
            primvar = _declared(primvars, name, values)
        if per_polygon(values):
            array = vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))
        else:
            kind = vt.Vec3fArray if values.ndim == 2 else vt.FloatArray
            array = kind.FromNumpy(np.ascontiguousarray(values, np.float32))
        primvar.Set(array, time_code)


def _declared(primvars, name: str, values: np.ndarray):
    """A new primvar for such values."""
    names, tokens = usd().Sdf.ValueTypeNames, usd().UsdGeom.Tokens
    if per_polygon(values):
        return primvars.CreatePrimvar(name, names.IntArray, tokens.uniform)
    return primvars.CreatePrimvar(name, names.Float3Array if values.ndim == 2 else names.FloatArray, tokens.vertex)


def _new_stage(extension: str):
    pxr = usd()
    layer = pxr.Sdf.Layer.CreateAnonymous(extension)
    return layer, pxr.Usd.Stage.Open(layer)


def _open(path: Path):
    """A stage of its own, never one that USD keeps in memory from before the file was replaced."""
    pxr = usd()
    if not path.is_file():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    try:
        return pxr.Usd.Stage.Open(pxr.Sdf.Layer.OpenAsAnonymous(str(path)))
    except pxr.Tf.ErrorException as error:
        raise InputError(f"{path}: cannot be read as USD; the file is damaged, bake again") from error


def _export(layer, path: Path) -> None:
    with _system_errors(path):
        layer.Export(str(path))


@contextmanager
def _system_errors(path: Path) -> Iterator[None]:
    """USD reports faults of the disk as text; turns them back into the OSError they were."""
    try:
        yield
    except usd().Tf.ErrorException as error:
        message = str(error)
        for code in (errno.ENOENT, errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EACCES, errno.EROFS, errno.EPERM):
            if os.strerror(code) in message:
                raise OSError(code, os.strerror(code), str(path)) from error
        raise OSError(errno.EIO, f"USD could not write it ({message.strip().splitlines()[-1]})", str(path)) from error
