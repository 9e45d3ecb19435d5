"""Pictures of an analysis for papers and reports: `--image OUT.png` of analyze, morse and track.

Left the surface with its field as evenly spaced streamlines and the entities in the thesis's colours (closed surfaces
from two opposite sides, flat ones from above, winds on a sphere as a map), right the graph in its three rows.
The format follows the ending of the path (png, pdf, svg). Everything raises InputError when matplotlib is missing, the
ending is unknown or the file cannot be written.
"""

from pathlib import Path
from typing import Any

import numpy as np

from .entities import EntityGraph


def draw_analysis(path: str | Path, mesh: Any, vectors: np.ndarray, graph: EntityGraph) -> None:
    """The field with its fixed points, periodic orbits and separatrices, beside the entity connection graph.

    mesh: native TriangleMesh. vectors: (n, 3) at its vertices, mesh units per second. graph: of the same field.
    """
    raise NotImplementedError


def draw_morse(path: str | Path, mesh: Any, vectors: np.ndarray, graph: EntityGraph, face_sets: np.ndarray) -> None:
    """The field with its Morse sets as coloured faces, beside the Morse connection graph.

    face_sets: (m,) int32, per face the Morse set it belongs to (id in graph.entities), -1 for none.
    """
    raise NotImplementedError


def draw_tracking(path: str | Path, mesh: Any, tracking: Any) -> None:
    """The paths of the fixed points over λ, coloured by λ, with bifurcations, beside their life spans.

    tracking.paths: each with kind (str) and samples (k, 4) of λ, x, y, z. tracking.bifurcations: each with lam,
    position (3,) and kind.
    """
    raise NotImplementedError
