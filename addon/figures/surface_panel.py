# SPDX-License-Identifier: GPL-3.0-or-later
"""One view of a surface in a picture, drawn by matplotlib: the shaded surface as an image, what is on it as lines.

What is hidden is left out by the depth buffer of the view (view.py), so lines stay smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from .. import native
from .view import View, look, shade

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: A word, a shade of grey as text, or red, green and blue in 0..1.
Colour = str | tuple[float, float, float]

#: Pixels of a view along its longer side; a map has more.
PIXELS, MAP_PIXELS = 1100, 1800
#: Widest streamline, points.
STREAMLINE = 1.1
#: How much wider separatrices are.
MARKED = 1.6
#: Arrow heads on streamlines: distance along the line and length, over the surface's size.
ARROW_EVERY, ARROW_LENGTH = 0.35, 0.02


class SurfacePanel:
    def __init__(self, axis: Axes, mesh: native.TriangleMesh, view: View) -> None:
        self.axis, self.mesh = axis, mesh
        self.sight = look(mesh, view, MAP_PIXELS if view.is_map else PIXELS)
        rows, columns = self.sight.shape
        axis.set_xlim(0, columns)
        axis.set_ylim(0, rows)
        axis.set_aspect("equal")
        if view.is_map:
            self._draw_degrees(columns, rows)
        else:
            axis.set_axis_off()
            axis.set_title(view.title, fontsize=9, color="0.4")

    def draw_surface(self, colours: np.ndarray) -> None:
        """colours: (m, 3) per face, 0..1."""
        rows, columns = self.sight.shape
        picture = shade(self.sight, colours)
        self.axis.imshow(picture, origin="lower", extent=(0, columns, 0, rows), interpolation="bilinear", zorder=0)

    def draw_streamlines(
        self, lines: native.EvenStreamlines, colour: str, role_colours: Mapping[int, Colour] = MappingProxyType({})
    ) -> None:
        """Lines as wide as their taper says, with arrow heads; some roles in a colour of their
        own and wider."""
        offsets, points, taper = lines.offsets, lines.points, lines.taper
        if not len(points):
            return
        after = np.arange(1, len(points) + 1)
        last = offsets[1:] - 1
        after[last] = np.where(lines.closed, offsets[:-1], last)
        normals = self._normals(points, lines.faces)
        width = STREAMLINE * (0.15 + 0.85 * np.minimum(taper, taper[after]))
        role = np.repeat(lines.roles, np.diff(offsets))
        marked = np.isin(role, list(role_colours))
        self._segments(points, normals, np.where(marked, np.arange(len(points)), after), colour, width, 1)
        self._arrows(lines, normals, after, colour)
        for number, own in role_colours.items():
            chosen = np.where(role == number, after, np.arange(len(points)))
            self._segments(points, normals, chosen, own, MARKED * width, 3)

    def draw_curves(self, curves: Sequence[np.ndarray], colour: Colour, width: float) -> None:
        """curves: (k, 3) polylines on the surface."""
        curves = [curve for curve in curves if len(curve) > 1]
        if not curves:
            return
        points = np.concatenate(curves)
        after = np.arange(1, len(points) + 1)
        ends = np.cumsum([len(curve) for curve in curves]) - 1
        after[ends] = ends
        self._segments(points, self._normals(points), after, colour, np.full(len(points), width), 3)

    def draw_coloured_path(self, points: np.ndarray, lambdas: np.ndarray, colour_of: Callable) -> None:
        """A path over λ, its colour by λ."""
        after = np.minimum(np.arange(1, len(points) + 1), len(points) - 1)
        colours = colour_of(0.5 * (lambdas + lambdas[after]))
        self._segments(points, self._normals(points), after, colours, np.full(len(points), 1.8), 3)

    def draw_points(self, points: np.ndarray, colours: Sequence[Colour], size: float = 34.0) -> None:
        """points: (k, 3) on the surface."""
        seen = self._seen(points)
        if seen.any():
            xy = self.sight.project(points[seen])
            chosen = [colour for colour, visible in zip(colours, seen, strict=True) if visible]
            edge = "0.15" if size < 30.0 else "white"
            self.axis.scatter(*xy.T, s=size, c=chosen, edgecolors=edge, linewidths=0.7, zorder=5)

    def draw_labels(self, points: np.ndarray, names: Sequence[str]) -> None:
        from matplotlib.patheffects import withStroke

        seen = self._seen(points)
        for point, name in [(p, n) for p, n, s in zip(points, names, seen, strict=True) if s]:
            self.axis.annotate(
                name, self.sight.project(point[None])[0], (4, 4), textcoords="offset points", fontsize=6.5,
                zorder=4, path_effects=[withStroke(linewidth=1.8, foreground="white")],
            )  # fmt: skip

    def _normals(self, points: np.ndarray, faces: np.ndarray | None = None) -> np.ndarray:
        """(k, 3) of the faces that the points lie on."""
        if faces is None:
            faces = self.mesh.closest_points(np.ascontiguousarray(points, np.float64))[0]
        return self.mesh.face_normals[faces]

    def _seen(self, points: np.ndarray) -> np.ndarray:
        if not len(points):
            return np.zeros(0, bool)
        return self.sight.sees(points, self._normals(points))

    def _segments(self, points, normals, after, colours, widths, zorder) -> None:
        from matplotlib.collections import LineCollection

        xy, seen = self.sight.project(points), self.sight.sees(points, normals)
        drawn = seen & seen[after] & (after != np.arange(len(points)))
        if self.sight.view.is_map:  # not across the edge of the map
            drawn &= np.abs(xy[after, 0] - xy[:, 0]) < 0.5 * self.sight.shape[1]
        if not drawn.any():
            return
        chosen = colours[drawn] if isinstance(colours, np.ndarray) else colours  # one per segment, or one for all
        segments = np.stack([xy[drawn], xy[after[drawn]]], axis=1)
        self.axis.add_collection(
            LineCollection(
                segments, linewidths=widths[drawn], colors=chosen, capstyle="round", zorder=zorder, rasterized=True
            ),
            autolim=False,
        )

    def _arrows(self, lines: native.EvenStreamlines, normals: np.ndarray, after: np.ndarray, colour: str) -> None:
        """Heads that point with the flow, in the middle of lines and at equal distances along long ones."""
        from matplotlib.collections import PolyCollection

        size = self.mesh.size
        heads = []
        for begin, end in zip(lines.offsets[:-1], lines.offsets[1:], strict=True):
            arc = lines.arc[begin:end]
            count = int(arc[-1] / (ARROW_EVERY * size) + 0.5)
            if count == 0 and arc[-1] > 4.0 * ARROW_LENGTH * size:
                count = 1
            heads.append(begin + np.searchsorted(arc, (np.arange(count) + 0.5) / max(count, 1) * arc[-1]))
        at = np.concatenate(heads).astype(np.int64)
        at = at[self.sight.sees(lines.points[at], normals[at]) & (lines.taper[at] > 0.3) & (after[at] != at)]
        xy = self.sight.project(lines.points)
        along = xy[after[at]] - xy[at]
        length = np.linalg.norm(along, axis=1)
        scale = 0.5 * ARROW_LENGTH * (180.0 if self.sight.view.is_map else size) * self.sight.scale
        kept = (length > 0.0) & (length < 20.0 * scale)
        at, along = at[kept], along[kept] / length[kept, None]
        aside = np.column_stack([-along[:, 1], along[:, 0]])
        tip, tail = xy[at] + 1.2 * scale * along, xy[at] - 0.8 * scale * along
        corners = np.stack([tip, tail + 0.55 * scale * aside, tail - 0.55 * scale * aside], axis=1)
        self.axis.add_collection(PolyCollection(corners, facecolors=colour, linewidths=0, zorder=2), autolim=False)

    def _draw_degrees(self, columns: int, rows: int) -> None:
        east, north = np.arange(-180, 181, 60), np.arange(-90, 91, 30)
        self.axis.set_xticks(
            (east + 180) / 360 * columns, [f"{abs(d)}°{'W' if d < 0 else 'E' if d else ''}" for d in east]
        )
        self.axis.set_yticks(
            (north + 90) / 180 * rows, [f"{abs(d)}°{'S' if d < 0 else 'N' if d else ''}" for d in north]
        )
        self.axis.tick_params(labelsize=7)
