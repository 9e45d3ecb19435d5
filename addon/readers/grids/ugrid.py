# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in NetCDF: UGRID topologies, and the meshes of MPAS, FESOM and others that name their triangles."""

from __future__ import annotations

import numpy as np

from ...model.errors import InputError
from .surface import Grid
from .unstructured import Cells, Nodes
from .vocabulary import standard_name, unit


def mesh_of(dataset, variable, where: str) -> Grid | None:
    """The mesh on which a variable lies; None where the file has none. Raises InputError where it lies on edges."""
    topology = _topology(dataset, variable)
    if topology is None:
        return _mpas(dataset, variable)
    nodes = _coordinates(dataset, topology, "node_coordinates", where)
    connectivity = topology.attrs.get("face_node_connectivity")
    if connectivity not in dataset.variables:
        raise InputError(f"{where}: the mesh {topology.name} names no face_node_connectivity; add it")
    polygons = _polygons(dataset[connectivity], topology, len(nodes), where)
    places, spherical = _in_degrees(dataset, topology, nodes)
    node_dim = dataset[_names(topology, "node_coordinates")[0]].dims[0]
    face_dim = topology.attrs.get("face_dimension", _face_dim(dataset[connectivity], topology))
    notes = (f"the mesh {topology.name} of {len(polygons)} faces",)
    if node_dim in variable.dims:
        return Nodes(places, polygons, (str(node_dim),), spherical, notes)
    if face_dim in variable.dims:
        centres = _centres(places, polygons, spherical)
        return Cells(centres, places, polygons, (str(face_dim),), spherical, notes)
    raise InputError(
        f"{where}: {variable.name} lies on {', '.join(map(str, variable.dims))}, neither the nodes nor the faces of "
        f"{topology.name}; vectors on edges have to be brought to one of these first"
    )


def _topology(dataset, variable):
    named = variable.attrs.get("mesh")
    if named in dataset.variables:
        return dataset[named]
    for name in dataset.variables:
        if (
            dataset[name].attrs.get("cf_role") == "mesh_topology"
            and dataset[name].attrs.get("topology_dimension", 2) == 2
        ):
            coordinates = _names(dataset[name], "node_coordinates")
            connectivity = dataset[name].attrs.get("face_node_connectivity")
            dims = {
                dim
                for known in [*coordinates, connectivity]
                if known in dataset.variables
                for dim in dataset[known].dims
            }
            if dims & set(variable.dims):
                return dataset[name]
    return None


def _names(topology, attribute: str) -> list[str]:
    return str(topology.attrs.get(attribute, "")).split()


def _coordinates(dataset, topology, attribute: str, where: str) -> np.ndarray:
    """(n, 2) x or longitude, y or latitude."""
    names = _names(topology, attribute)
    if len(names) != 2 or any(name not in dataset.variables for name in names):
        raise InputError(
            f"{where}: the mesh {topology.name} needs two {attribute} that exist; it names {names or 'none'}"
        )
    first, second = names
    if standard_name(dataset[first]) in ("latitude", "projection_y_coordinate") or unit(dataset[first]).startswith(
        "degrees_n"
    ):
        first, second = second, first
    return np.column_stack([dataset[name].values.astype(np.float64) for name in (first, second)])


def _in_degrees(dataset, topology, nodes: np.ndarray) -> tuple[np.ndarray, bool]:
    """Nodes in degrees, or in metres of a plane, and whether they lie on the sphere."""
    kinds = [
        (unit(dataset[name]).lower(), standard_name(dataset[name])) for name in _names(topology, "node_coordinates")
    ]
    if any("radian" in of for of, _ in kinds):
        return np.degrees(nodes), True
    if any("degree" in of or meaning in ("latitude", "longitude") for of, meaning in kinds):
        return nodes, True
    plane = any(
        meaning.startswith("projection") or of in ("m", "km", "meter", "meters", "metre", "metres")
        for of, meaning in kinds
    )
    if plane:
        return nodes * (1000.0 if any(of == "km" for of, _ in kinds) else 1.0), False
    return nodes, bool(np.abs(nodes[:, 1]).max() <= 90.0 and np.abs(nodes[:, 0]).max() <= 360.0)


def _face_dim(connectivity, topology) -> str:
    return str(connectivity.dims[1] if _is_turned(connectivity) else connectivity.dims[0])


def _is_turned(connectivity) -> bool:
    """Whether the first dimension counts corners, as UGRID allows where face_dimension says so."""
    return connectivity.shape[0] in (3, 4) and connectivity.shape[1] > 4


def _polygons(connectivity, topology, nodes: int, where: str) -> np.ndarray:
    """(m, k) corners from 0, −1 where there are fewer."""
    values = np.asarray(connectivity.values)
    if topology.attrs.get("face_dimension") == connectivity.dims[-1] or _is_turned(connectivity):
        values = values.T
    fill = connectivity.encoding.get("_FillValue", connectivity.attrs.get("_FillValue"))
    missing = ~np.isfinite(values.astype(np.float64)) | (values < 0)
    if fill is not None:
        missing |= values == fill
    start = connectivity.attrs.get("start_index")
    if start is None:
        start = 1 if values[~missing].min() == 1 and values[~missing].max() == nodes else 0
    corners = np.where(missing, -1, values - int(start)).astype(np.int64)
    if corners.max() >= nodes or (corners[~missing] < 0).any():
        raise InputError(f"{where}: {connectivity.name} names node {values[~missing].max():g}, but there are {nodes}")
    return corners


def _centres(places: np.ndarray, polygons: np.ndarray, spherical: bool) -> np.ndarray:
    from .surface import on_sphere

    present = polygons >= 0
    points = on_sphere(places[:, 1], places[:, 0]) if spherical else places
    mean = (points[polygons] * present[..., None]).sum(axis=1) / present.sum(axis=1)[:, None]
    if not spherical:
        return mean
    return np.degrees(
        np.column_stack([np.arctan2(mean[:, 1], mean[:, 0]), np.arctan2(mean[:, 2], np.hypot(mean[:, 0], mean[:, 1]))])
    )


def _mpas(dataset, variable) -> Grid | None:
    """MPAS: values at cells, whose centres are joined by the triangles of cellsOnVertex."""
    if "cellsOnVertex" not in dataset.variables or "nCells" not in variable.dims or "latCell" not in dataset.variables:
        return None
    places = np.degrees(np.column_stack([dataset["lonCell"].values, dataset["latCell"].values]).astype(np.float64))
    triangles = dataset["cellsOnVertex"].values.astype(np.int64) - 1
    return Nodes(places, triangles[(triangles >= 0).all(axis=1)], ("nCells",), True, ("the dual mesh of MPAS",))
