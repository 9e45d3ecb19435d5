"""EXR flow maps: the field as an image sequence over a UV layer, for shaders that know nothing of the mesh.

One frames/frame_0001.exr per frame, numbered so that Blender's Image Sequence finds them; colour space Non-Color.
Channels, basis and units stand in the header of every image (metadata()) and in native/io/flow_map.h.
"""

import hashlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .. import native
from ..model.errors import InputError
from ..model.mesh_data import MeshData
from .manifest import MeshIdentity, Plan
from .store import CacheStore

BASES = ("uv", "object")


@dataclass(frozen=True)
class ExrSettings:
    uv_layer: str = ""  #: empty: the only or first layer
    resolution: int = 1024  #: width and height, pixels
    field: str = "advection"  #: or "orientation"
    basis: str = "uv"  #: "uv": velocity of the UV coordinates and speed; "object": the vector itself
    half: bool = False  #: 16 instead of 32 bit floats
    margin: int = 8  #: pixels around each island


class FlowMapWriter:
    """Draws one image per frame: prepare() and prepared() once, then draw() each.

    Raises InputError when the UV layer is missing or shows nothing.
    """

    def __init__(self, folder: Path, mesh: MeshData, frames, settings: ExrSettings, baked_from, *, resume: bool):
        layer = find_layer(mesh, settings.uv_layer)
        if settings.basis not in BASES:
            raise InputError(f"the basis of flow maps is '{settings.basis}'; choose one of {', '.join(BASES)}")
        self._settings = settings
        self._identity = MeshIdentity.of(mesh)
        self._layer = layer
        self._uvs = mesh.uv_layers[layer]
        seen = {"uv_layer": layer, "uv_sha256": hashlib.sha256(self._uvs.tobytes()).hexdigest()}
        content = {"exr": asdict(settings) | seen, "from": baked_from}
        plan = Plan("exr", "frame", tuple(int(frame) for frame in frames), self._identity, content)
        self.store = CacheStore(folder, plan, resume=resume, replace=True)
        self._map: Any = None

    def prepare(self, native_mesh):
        """Begins, on other threads, to find what each pixel shows, once for all frames: a job for prepared()."""
        size, margin = self._settings.resolution, self._settings.margin
        return native.start_flow_map(native_mesh, self._uvs, size, size, margin)

    def prepared(self, job) -> list[str]:
        """Waits for the job of prepare(); returns remarks for the artist."""
        self._map = job.result()
        return remarks(self._map, self._layer)

    def draw(self, field, lam: float):
        """Begins an image on other threads: a job whose result is the file's bytes, for store.write_bytes().

        field: native.VectorField at λ, on the mesh given to prepare().
        """
        settings = self._settings
        return self._map.start_exr(field, settings.basis, settings.half, self.metadata(lam))

    def finish(self) -> bool:
        return self.store.finish({})

    def metadata(self, lam: float) -> dict[str, str]:
        channels = {
            "uv": "R, G: velocity of u and v, UV units per second; B: speed, mesh units per second; A: 1 on the mesh",
            "object": "R, G, B: vector in object space, mesh units per second; A: 1 on the mesh",
        }
        return {
            "stormfield:basis": self._settings.basis,
            "stormfield:channels": channels[self._settings.basis],
            "stormfield:field": self._settings.field,
            "stormfield:lambda": repr(float(lam)),
            "stormfield:mesh": self._identity.fingerprint,
            "stormfield:uv_layer": self._layer,
        }


def remarks(flow_map, layer: str) -> list[str]:
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
