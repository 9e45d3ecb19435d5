# SPDX-License-Identifier: GPL-3.0-or-later
"""EXR flow maps: the field as an image sequence over a UV layer, for shaders that know nothing of the mesh.

One frames/frame_0001.exr per frame; colour space Non-Color. Channels, basis and units stand in the header of every
image (metadata()) and in native/io/flow_map.h.
"""

import hashlib
from dataclasses import asdict
from typing import Any

import numpy as np

from ... import native
from ...cache import fields
from ...model.errors import InputError
from ...model.mesh_data import MeshData
from ..task import BakeTask
from .frame_files import FrameFiles

#: What the channels hold, by basis.
CHANNELS = {
    "uv": "R, G: velocity of u and v, UV units per second; B: speed, mesh units per second; A: 1 on the mesh",
    "object": "R, G, B: vector in object space, mesh units per second; A: 1 on the mesh",
}


class FlowMaps(FrameFiles):
    name = "exr"
    preparing = "Reading the UV layer"
    making = "Drawing the flow map"

    @staticmethod
    def check(task: BakeTask) -> None:
        find_layer(task.mesh, task.exr.uv_layer)
        if task.exr.basis not in CHANNELS:
            raise InputError(f"the basis of flow maps is '{task.exr.basis}'; choose one of {', '.join(CHANNELS)}")
        if task.exr.field not in fields.ATTRIBUTE:
            raise InputError(f"flow maps of field '{task.exr.field}'; choose one of {', '.join(fields.ATTRIBUTE)}")

    def _settings(self) -> dict[str, Any]:
        self._layer = find_layer(self._task.mesh, self._task.exr.uv_layer)
        self._uvs = self._task.mesh.uv_layers[self._layer]
        digest = hashlib.sha256(self._uvs.tobytes()).hexdigest()
        return asdict(self._task.exr) | {"uv_layer": self._layer, "uv_sha256": digest}

    def _start_shared(self, mesh: Any) -> Any:
        size, margin = self._task.exr.resolution, self._task.exr.margin
        return native.start_flow_map(mesh, self._uvs, size, size, margin)

    def _start_file(self, shared: Any, sample: dict[str, np.ndarray], mesh: Any, lam: float) -> Any:
        settings = self._task.exr
        field = fields.field_at(sample, fields.ATTRIBUTE[settings.field], mesh)
        return shared.start_exr(field, settings.basis, settings.half, self.metadata(lam))

    def _remarks(self, shared: Any) -> list[str]:
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


def remarks(flow_map: Any, layer: str) -> list[str]:
    """What an artist should know about the UV layer; empty when all is well. flow_map: native FlowMap."""
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
