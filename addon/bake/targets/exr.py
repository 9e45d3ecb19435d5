# SPDX-License-Identifier: GPL-3.0-or-later
"""EXR flow maps: the field as an image sequence over a UV layer, for shaders that know nothing of the mesh.

One frames/frame_0001.exr per frame; colour space Non-Color. Channels, basis and units stand in the header of every
image (metadata()) and in native/io/flow_map.h.
"""

from __future__ import annotations

import hashlib
from collections.abc import Generator
from dataclasses import asdict
from pathlib import Path

import numpy as np

from ... import native
from ...cache import fields
from ...cache.bundled import bundled
from ...model.errors import InputError
from ...model.mesh_data import MeshData
from ...model.words import FlowMapBasis, Json
from ...work import Steps, result_of
from ..task import BakeTask
from .frame_files import FrameFiles
from .writing import disk_faults

#: Rows that OpenEXR compresses together, and pixels that are written between two steps.
ROWS, PIXELS = 16, 1 << 18
#: What the channels hold, by basis.
CHANNELS: dict[FlowMapBasis, str] = {
    "uv": "R, G: velocity of u and v, UV units per second; B: speed, mesh units per second; A: 1 on the mesh",
    "object": "R, G, B: vector in object space, mesh units per second; A: 1 on the mesh",
}


class FlowMaps(FrameFiles["native.FlowMap", np.ndarray]):
    name = "exr"
    preparing = "Reading the UV layer"
    making = "Drawing the flow map"

    @staticmethod
    def check(task: BakeTask) -> None:
        bundled("OpenImageIO")
        find_layer(task.mesh, task.exr.uv_layer)
        if task.exr.basis not in CHANNELS:
            raise InputError(f"the basis of flow maps is '{task.exr.basis}'; choose one of {', '.join(CHANNELS)}")
        if task.exr.field not in fields.ATTRIBUTE:
            raise InputError(f"flow maps of field '{task.exr.field}'; choose one of {', '.join(fields.ATTRIBUTE)}")

    @classmethod
    def _settings(cls, task: BakeTask) -> dict[str, Json]:
        layer = find_layer(task.mesh, task.exr.uv_layer)
        digest = hashlib.sha256(task.mesh.uv_layers[layer].tobytes()).hexdigest()
        return asdict(task.exr) | {"uv_layer": layer, "uv_sha256": digest}

    @property
    def _layer(self) -> str:
        return find_layer(self._task.mesh, self._task.exr.uv_layer)

    def _start_shared(self, mesh: native.TriangleMesh) -> native.FlowMapJob:
        size, margin = self._task.exr.resolution, self._task.exr.margin
        return native.start_flow_map(mesh, self._surface.mesh.uv_layers[self._layer], size, size, margin)

    def _make(
        self, shared: native.FlowMap, sample: dict[str, np.ndarray], mesh: native.TriangleMesh, message: str
    ) -> Steps[np.ndarray]:
        field = fields.field_at(sample, fields.ATTRIBUTE[self._task.exr.field], mesh)
        image = yield from result_of(shared.start_image(field, self._task.exr.basis), 0.0, message)
        if self._task.exr.half:
            check_half(image)
        return image

    def _write(self, shared: native.FlowMap, content: np.ndarray, lam: float, path: Path) -> Generator[float]:
        yield from write_image(path, content, self.metadata(lam), half=self._task.exr.half)

    def _remarks(self, shared: native.FlowMap) -> list[str]:
        return remarks(shared, self._layer)

    def metadata(self, lam: float) -> dict[str, str]:
        """The header of the image at λ."""
        return {
            "stormfield:basis": self._task.exr.basis,
            "stormfield:channels": CHANNELS[self._task.exr.basis],
            "stormfield:field": self._task.exr.field,
            "stormfield:lambda": repr(float(lam)),
            "stormfield:mesh": self._identity.fingerprint,
            "stormfield:uv_layer": self._layer,
        }


def write_image(path: Path, image: np.ndarray, metadata: dict[str, str], *, half: bool) -> Generator[float]:
    """Writes (height, width, 4) float32 as OpenEXR in steps: ZIP, 32 bit floats or (half) 16, metadata in the header.
    Equal input gives equal bytes in one version of Blender."""
    oiio = bundled("OpenImageIO")
    height, width, channels = image.shape
    spec = oiio.ImageSpec(width, height, channels, "half" if half else "float")
    spec.attribute("compression", "zip")
    spec.attribute("oiio:ColorSpace", "raw")
    # Without a date OpenImageIO writes the present one, and no two bakes would be equal.
    spec.attribute("DateTime", "1970:01:01 00:00:00")
    for name, text in metadata.items():
        spec.attribute(name, text)
    output = oiio.ImageOutput.create(str(path))

    def check(done: bool) -> None:
        if not done:
            raise RuntimeError((output or oiio).geterror())

    rows = ROWS * max(1, PIXELS // (ROWS * width))
    with disk_faults(path):
        check(output is not None and output.open(str(path), spec))
        try:
            for first in range(0, height, rows):
                last = min(first + rows, height)
                check(output.write_scanlines(first, last, 0, np.ascontiguousarray(image[first:last])))
                yield last / height
        finally:
            closed = output.close()
        check(closed)


def check_half(image: np.ndarray) -> None:
    """Raises InputError naming the first pixel that holds more than 16 bit floats can."""
    beyond = np.abs(image).max(axis=2) > np.finfo(np.float16).max
    if beyond.any():
        y, x = np.argwhere(beyond)[0]
        raise InputError(
            f"pixel ({x}, {y}) holds {np.abs(image[y, x]).max():g}, more than 16 bit floats can; write 32 bit floats"
        )


def remarks(flow_map: native.FlowMap, layer: str) -> list[str]:
    """What an artist should know about the UV layer; empty when all is well."""
    found = []
    if flow_map.overlapping_pixels:
        share = flow_map.overlapping_pixels / max(1, flow_map.covered_pixels)
        found.append(f"UV layer '{layer}' overlaps itself on {share:.1%} of its pixels; there the first face shows")
    if flow_map.zero_area_faces:
        found.append(f"UV layer '{layer}' gives {flow_map.zero_area_faces} triangles no area; they show nowhere")
    if flow_map.outside_faces:
        found.append(
            f"UV layer '{layer}' has {flow_map.outside_faces} triangles outside 0..1; they show in part or not"
        )
    return found


def find_layer(mesh: MeshData, name: str) -> str:
    """The UV layer meant by `name`, the first when that is empty. Raises InputError naming those present."""
    present = list(mesh.uv_layers)
    if not present:
        raise InputError("EXR flow maps need a UV layer and the mesh has none; unwrap it, or bake another target")
    if not name:
        return present[0]
    if name not in present:
        listed = ", ".join(f"'{layer}'" for layer in present)
        raise InputError(f"the mesh has no UV layer '{name}'; choose one of {listed}")
    return name
