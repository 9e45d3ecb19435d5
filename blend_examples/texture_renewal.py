# SPDX-License-Identifier: GPL-3.0-or-later
"""What share of the texture must be made anew in each frame, if it is carried from frame to frame along the flow.

    python blend_examples/texture_renewal.py [--detail -1] [--frames 84] [--out FOLDER]

On the storm merge, with a texel at every vertex. It carries the gradients of its two texture coordinates, which one
frame along the flow turns and strains. It is renewed, upright and unstrained, where it is stretched or squeezed by more
than a bound, or turned away from the orientation field by more than another; the second counts less where that field is
weak. Printed are the mean shares of area over the second half of the frames. A sphere that turns as a whole renews
nothing.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import example
import flicker

#: Of the mean length of the orientation field: below it, its direction counts in proportion.
WEAK = 0.2
FPS = 24.0


@dataclass(frozen=True)
class Bounds:
    stretch: float  #: largest ratio of lengths, above 1
    angle: float  #: degrees from the orientation field; 180: texture is carried and never turned back


BOUNDS = tuple(Bounds(stretch, angle) for angle in (180.0, 30.0, 15.0) for stretch in (1.25, 1.5, 2.0))


class Surface:
    """A closed mesh with its gradients."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self.points, self.triangles = points, triangles
        corners = points[triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        double = np.linalg.norm(cross, axis=1)
        normal = cross / double[:, None]
        # Of the barycentric coordinate of each corner: the opposite side, turned, over twice the area.
        self.gradient = np.stack(
            [np.cross(normal, corners[:, (i + 2) % 3] - corners[:, (i + 1) % 3]) / double[:, None] for i in range(3)],
            axis=1,
        )
        self.area = 0.5 * double
        self.vertex_area = flicker.vertex_areas(points, triangles)
        self.normals = self._at_vertices(normal)
        self.normals /= np.linalg.norm(self.normals, axis=1)[:, None]

    def derivative(self, values: np.ndarray) -> np.ndarray:
        """Of vectors (n, 3) at vertices: (n, 3, 3), [value's axis, direction], means over the faces around."""
        of_faces = np.einsum("fia,fib->fab", values[self.triangles], self.gradient)
        return self._at_vertices(of_faces.reshape(-1, 9)).reshape(-1, 3, 3)

    def _at_vertices(self, of_faces: np.ndarray) -> np.ndarray:
        total = np.zeros((len(self.points), of_faces.shape[1]))
        for corner in range(3):
            for k in range(of_faces.shape[1]):
                total[:, k] += np.bincount(
                    self.triangles[:, corner], self.area * of_faces[:, k], minlength=len(self.points)
                )
        return total / (3.0 * self.vertex_area[:, None])


def frame_of(surface: Surface, orientation: np.ndarray) -> np.ndarray:
    """Unit vectors along and across the field (n, 2, 3); where it is zero, any."""
    across = np.cross(surface.normals, orientation + 1e-12)
    across /= np.linalg.norm(across, axis=1)[:, None]
    return np.stack([np.cross(across, surface.normals), across], axis=1)


def strain(gradients: np.ndarray, frame: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest ratio of lengths, and angle to the frame in degrees, of gradients (n, 2, 3)."""
    matrix = np.einsum("nca,nda->ncd", gradients, frame)
    values = np.linalg.svd(matrix, compute_uv=False)
    stretch = np.maximum(values[:, 0], 1.0 / np.maximum(values[:, 1], 1e-9))
    turn = np.arctan2(matrix[:, 1, 0] - matrix[:, 0, 1], matrix[:, 0, 0] + matrix[:, 1, 1])
    return stretch, np.degrees(np.abs(turn))


def shares(surface: Surface, native: Any, fields: dict[str, Any], lambdas: np.ndarray) -> dict[Bounds, list[float]]:
    """Share of area that is renewed at each frame but the first. fields: orientation as a function of λ, and advection
    as native.ParameterizedField; lambdas: of frames 0, 1, …"""
    count = len(surface.points)
    faces, barycentric = any_face_of(surface.triangles, count)
    times = np.arange(len(lambdas)) / FPS
    orientations = fields["orientation"](lambdas[0])
    states = {bounds: frame_of(surface, orientations) for bounds in BOUNDS}
    found: dict[Bounds, list[float]] = {bounds: [] for bounds in BOUNDS}
    for index in range(1, len(lambdas)):
        traces = native.pathlines(
            fields["advection"], times, lambdas, faces, barycentric, times[index], 1.0 / FPS, direction="backward"
        )
        last = traces.offsets[1:] - 1
        way = surface.derivative(traces.points[last])
        corners, weights = surface.triangles[traces.faces[last]], traces.barycentric[last]
        orientation = fields["orientation"](lambdas[index])
        frame, length = frame_of(surface, orientation), np.linalg.norm(orientation, axis=1)
        sure = np.minimum(1.0, length / (WEAK * length.mean()))
        for bounds, gradients in states.items():
            before = np.einsum("ni,nica->nca", weights, gradients[corners])
            carried = np.einsum("nca,nab->ncb", before, way)
            stretch, angle = strain(carried, frame)
            renewed = (stretch > bounds.stretch) | (angle * sure > bounds.angle)
            states[bounds] = np.where(renewed[:, None, None], frame, carried)
            found[bounds].append(float(surface.vertex_area[renewed].sum() / surface.vertex_area.sum()))
    return found


def any_face_of(triangles: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Each vertex as a point of a face."""
    faces, corners = np.zeros(count, np.int32), np.zeros(count, np.int64)
    for corner in range(3):
        faces[triangles[:, corner]] = np.arange(len(triangles))
        corners[triangles[:, corner]] = corner
    return faces, np.eye(3)[corners]


def report(name: str, found: dict[Bounds, list[float]]) -> None:
    for bounds, of_frames in found.items():
        later = 100.0 * np.array(of_frames[len(of_frames) // 2 :])
        turned = "carried" if bounds.angle == 180.0 else f"within {bounds.angle:.0f}° of the field"
        print(
            f"{name}: stretch {bounds.stretch}, {turned}: {later.mean():.2f} % a frame, at most {later.max():.2f} %",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=example.REPOSITORY / "out" / "texture_renewal")
    parser.add_argument("--frames", type=int, default=84, help="length of the animation")
    parser.add_argument("--detail", type=int, default=-1, help="0: the whole mesh; each step down is a quarter of it")
    given = parser.parse_args()
    options = example.Options(given.out, given.frames, 100, None, given.detail, "none", False)
    example.begin(options)
    native = example.part("native")
    planet = example.part("presets.storm_merge").build(bpy.context, 7 + given.detail, given.frames)
    bpy.ops.wm.save_as_mainfile(filepath=str(given.out / "texture_renewal.blend"))
    bpy.context.view_layer.objects.active = planet
    bpy.ops.stormfield.solve()
    attached, caches = example.part("scene.read.attached"), example.part("cache.field_cache")
    cache = caches.open_cache(attached.attached_folder(planet, attached.LAMBDA))
    surface = Surface(cache.mesh.vertices.astype(np.float64), cache.mesh.triangles)
    mesh = native.TriangleMesh(surface.points, surface.triangles)

    still = np.cross((0.0, 0.0, 0.7), surface.points)
    rigid = native.ParameterizedField(mesh, np.zeros(1), mesh.to_tangent(still)[None])
    report(
        "turning as a whole",
        shares(surface, native, {"orientation": lambda _: still, "advection": rigid}, np.zeros(12)),
    )

    samples, places = cache.values("sf_orientation").astype(np.float64), np.asarray(cache.lambdas)

    def orientation(lam: float) -> np.ndarray:
        place = float(np.interp(lam, places, np.arange(len(places))))
        first = min(int(place), len(places) - 2)
        return (1.0 - place + first) * samples[first] + (place - first) * samples[first + 1]

    advection = native.ParameterizedField(
        mesh, cache.lambdas, mesh.to_tangent(cache.values("sf_advection").astype(np.float64))
    )
    lambdas = np.linspace(0.0, 1.0, given.frames)
    report("storm merge", shares(surface, native, {"orientation": orientation, "advection": advection}, lambdas))


if __name__ == "__main__":
    example.run(main)
