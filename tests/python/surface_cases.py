# SPDX-License-Identifier: GPL-3.0-or-later
"""A field with a known answer on a sphere, and how other programs write it."""

import contextlib
import io

import meshio
import numpy as np
import pytest
from stormfield.readers.icosphere import icosphere

pytest.importorskip("vtkmodules", reason="VTK is not installed: pip install vtk")
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkUnstructuredGrid

#: Kinds of the fixed points of flow() on a sphere: at the ends of the three axes.
KINDS = {"source": 2, "saddle": 2, "sink": 2}


def flow(points, turn=0.0):
    """The gradient of 3x² + 2y² + z² on a sphere about 0, turned by `turn` about z: tangent, six fixed points."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    gradient = points @ (turned @ np.diag([3.0, 2.0, 1.0]) @ turned.T)
    return gradient - (gradient * normals).sum(axis=1, keepdims=True) * normals


def ball(faces=1280):
    mesh = icosphere(faces)
    return np.array(mesh.vertices), np.array(mesh.triangles, np.int64)


def grid_sphere(rows=24, columns=48):
    """Quads of a latitude-longitude grid: a doubled seam, poles that are rows."""
    phi, theta = np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, columns)
    p, t = np.meshgrid(phi, theta, indexing="ij")
    points = np.stack([np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p)], axis=-1).reshape(-1, 3)
    return points, grid_quads(rows, columns)


def grid_quads(rows, columns):
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    return np.stack([first, first + columns, first + columns + 1, first + 1], axis=1)


def write_mesh(path, points, triangles, cell="triangle", point_data=None, cell_data=None, **options):
    cell_data = {name: [values] for name, values in (cell_data or {}).items()}
    with contextlib.redirect_stderr(io.StringIO()):  # meshio says what it does to whole numbers
        meshio.write(path, meshio.Mesh(points, [(cell, triangles)], point_data or {}, cell_data), **options)
    return path


def cells_of(rows):
    ends = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    cells = vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(ends, 1), numpy_to_vtkIdTypeArray(np.concatenate(rows).astype(np.int64), 1))
    return cells


def with_data(data, points, point_data=None, cell_data=None):
    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), 1))
    data.SetPoints(places)
    for attributes, arrays in ((data.GetPointData(), point_data or {}), (data.GetCellData(), cell_data or {})):
        for name, values in arrays.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), 1)
            array.SetName(name)
            attributes.AddArray(array)
    return data


def poly_data(points, polygons, point_data=None, cell_data=None):
    data = with_data(vtkPolyData(), points, point_data, cell_data)
    data.SetPolys(cells_of(list(polygons)))
    return data


def grid(points, cells, types, point_data=None, cell_data=None):
    data = with_data(vtkUnstructuredGrid(), points, point_data, cell_data)
    data.SetCells(numpy_to_vtk(np.asarray(types, np.uint8), 1), cells_of(list(cells)))
    return data


def write_vtk(path, data):
    from vtkmodules.vtkIOGeometry import vtkSTLWriter
    from vtkmodules.vtkIOLegacy import vtkDataSetWriter
    from vtkmodules.vtkIOXML import vtkXMLDataSetWriter, vtkXMLMultiBlockDataWriter

    kinds = {".vtk": vtkDataSetWriter, ".stl": vtkSTLWriter, ".vtm": vtkXMLMultiBlockDataWriter}
    writer = kinds.get(path.suffix, vtkXMLDataSetWriter)()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    assert writer.Write() == 1
    return path


def second_order(points, triangles):
    """Six corners for each triangle: the middle of each edge once, on the sphere."""
    pairs = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
    middle = points[unique].mean(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    corners = np.column_stack([triangles, len(points) + inverse.reshape(3, -1).T])
    return np.concatenate([points, middle]), corners


def write_xdmf(path, points, triangles, series):
    """XDMF as text: a grid, or a collection over time where there are several (time, vectors)."""

    def numbers(values, kind):
        rows, columns = values.shape
        text = "\n".join(" ".join(map(repr, row)) for row in values.tolist())
        shape = f'Dimensions="{rows} {columns}" NumberType="{kind}" Precision="8" Format="XML"'
        return f"<DataItem {shape}>{text}</DataItem>"

    grids = "".join(
        f'<Grid Name="wall" GridType="Uniform"><Time Value="{time}"/>'
        f'<Topology TopologyType="Triangle" NumberOfElements="{len(triangles)}">{numbers(triangles, "Int")}</Topology>'
        f'<Geometry GeometryType="XYZ">{numbers(points, "Float")}</Geometry>'
        f'<Attribute Name="WSS" AttributeType="Vector" Center="Node">{numbers(vectors, "Float")}</Attribute></Grid>'
        for time, vectors in series
    )
    if len(series) > 1:
        grids = f'<Grid Name="all" GridType="Collection" CollectionType="Temporal">{grids}</Grid>'
    path.write_text(f'<?xml version="1.0"?><Xdmf Version="3.0"><Domain>{grids}</Domain></Xdmf>')
    return path


def write_pvd(path, entries):
    rows = "".join(f'<DataSet timestep="{time}" part="{part}" file="{file}"/>' for time, part, file in entries)
    path.write_text(f'<VTKFile type="Collection" version="0.1"><Collection>{rows}</Collection></VTKFile>')
    return path
