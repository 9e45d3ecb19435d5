# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces over time: collections, numbered files, folders and files of several times, by the times that they have."""

import json

import numpy as np
import pytest
from command_line import refused, run
from surface_cases import ball, flow, poly_data, with_data, write_mesh, write_pvd, write_vtk, write_xdmf
from vtkmodules.vtkCommonDataModel import vtkPolyData

POINTS, TRIANGLES = ball()
TIMES = [0.0, 6.0, 12.0, 36.0, 42.0, 48.0]
LAMBDAS = [0.0, 0.125, 0.25, 0.75, 0.875, 1.0]


def wall(time, points=POINTS, name="WSS", stamp=None):
    """The field turns by 0.3 radians in 48 hours."""
    data = poly_data(points, TRIANGLES, {name: flow(POINTS, time / 160)})
    if stamp is not None:
        array = with_data(vtkPolyData(), POINTS[:1], {"TimeValue": np.array([stamp])}).GetPointData().GetArray(0)
        data.GetFieldData().AddArray(array)
    return data


def tracking(capsys, path, *options):
    status, out, err = run(capsys, "track", path, *options, "--json", "-")
    assert status == 0, err
    return json.loads(out)


def assert_followed(content, lambdas=LAMBDAS):
    """Six paths of the whole life that turn with the field: the source is where the axis is."""
    assert np.allclose(content["lam"], lambdas, atol=1e-12)
    assert not content["bifurcations"] and len(content["paths"]) == 6
    for path in content["paths"]:
        assert path["life"] == 1.0


def files(folder, times=TIMES, ending="vtp", names="wall_{:04d}", **options):
    folder.mkdir(exist_ok=True)
    return [write_vtk(folder / f"{names.format(k)}.{ending}", wall(time, **options)) for k, time in enumerate(times)]


def test_pvd(capsys, tmp_path):
    entries = [(time, 0, file.name) for time, file in zip(TIMES, files(tmp_path), strict=True)]
    content = tracking(capsys, write_pvd(tmp_path / "wall.pvd", entries))
    assert_followed(content)
    assert content["read"]["times"] == TIMES and len(content["read"]["files"]) == 6


def test_parts_of_one_time_are_one_surface(capsys, tmp_path):
    north = POINTS[TRIANGLES].mean(axis=1)[:, 2] > 0
    entries = []
    for k, time in enumerate(TIMES[:3]):
        for part, side in enumerate((north, ~north)):
            data = poly_data(POINTS, TRIANGLES[side], {"WSS": flow(POINTS, time / 160)})
            entries.append((time, part, write_vtk(tmp_path / f"w{k}_{part}.vtp", data).name))
    content = tracking(capsys, write_pvd(tmp_path / "wall.pvd", entries))
    assert_followed(content, [0, 0.5, 1])
    assert content["mesh"]["boundary_loops"] == 0 and content["mesh"]["components"] == 1


def test_vtm_blocks_over_time(capsys, tmp_path):
    from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

    entries = []
    for k, time in enumerate(TIMES[:3]):
        data = vtkMultiBlockDataSet()
        data.SetBlock(0, wall(time))
        entries.append((time, 0, write_vtk(tmp_path / f"wall{k}.vtm", data).name))
    assert_followed(tracking(capsys, write_pvd(tmp_path / "wall.pvd", entries)), [0, 0.5, 1])


def test_series_file(capsys, tmp_path):
    entries = [{"name": file.name, "time": time} for time, file in zip(TIMES, files(tmp_path), strict=True)]
    path = tmp_path / "wall.vtp.series"
    path.write_text(json.dumps({"file-series-version": "1.0", "files": entries}))
    assert_followed(tracking(capsys, path))


@pytest.mark.parametrize("given", ["folder", "pattern", "one of them"])
def test_numbered_files(capsys, tmp_path, given):
    names = [f"wall_{time:04.0f}" for time in TIMES]
    paths = [write_vtk(tmp_path / f"{name}.vtu", with_cells(time)) for name, time in zip(names, TIMES, strict=True)]
    field = {"folder": tmp_path, "pattern": tmp_path / "wall_*.vtu", "one of them": paths[2]}[given]
    content = tracking(capsys, field)
    assert_followed(content)
    assert content["read"]["times"] == [] and "numbers in their names" in " ".join(content["read"]["notes"])
    assert len(content["read"]["files"]) == 6


def with_cells(time):
    from surface_cases import grid

    return grid(POINTS, TRIANGLES, [5] * len(TRIANGLES), {"WSS": flow(POINTS, time / 160)})


def test_a_pattern_that_the_shell_replaces_is_told_to_be_quoted(capsys, tmp_path):
    line = refused(capsys, "track", *files(tmp_path), "--json", "-")
    assert "wall_0000.vtp and 5 more names: give one FIELD; put a pattern in quotes" in line


def test_one_numbered_file_is_one_time_to_analyze(capsys, tmp_path):
    paths = files(tmp_path)
    status, out, _ = run(capsys, "analyze", paths[3], "--json", "-")
    assert status == 0 and json.loads(out)["read"]["files"] == [str(paths[3])]


def test_times_inside_the_files_count_more_than_numbers(capsys, tmp_path):
    for k, time in enumerate(TIMES):
        write_vtk(tmp_path / f"w{k}.vtp", wall(time, stamp=time))
    content = tracking(capsys, tmp_path)
    assert_followed(content)
    assert content["read"]["times"] == TIMES and content["read"]["notes"] == []


def test_folders_named_by_times(capsys, tmp_path):
    for time in TIMES:
        (tmp_path / f"{time / 1000:g}").mkdir()
        write_vtk(tmp_path / f"{time / 1000:g}" / "wall.vtp", wall(time))
    content = tracking(capsys, tmp_path)
    assert_followed(content)
    assert content["read"]["times"] == [time / 1000 for time in TIMES]


def test_xdmf(capsys, tmp_path):
    series = [(time, flow(POINTS, time / 160)) for time in TIMES]
    content = tracking(capsys, write_xdmf(tmp_path / "wall.xdmf", POINTS, TRIANGLES, series))
    assert_followed(content)
    assert content["read"]["times"] == TIMES


def test_xdmf_as_meshio_writes_it(capsys, tmp_path):
    pytest.importorskip("h5py")
    import meshio

    with meshio.xdmf.TimeSeriesWriter(tmp_path / "wall.xdmf", data_format="XML") as writer:
        writer.write_points_cells(POINTS, [("triangle", TRIANGLES)])
        for time in TIMES:
            writer.write_data(time, point_data={"WSS": flow(POINTS, time / 160)})
    assert_followed(tracking(capsys, tmp_path / "wall.xdmf"))


def test_exodus(capsys, tmp_path):
    from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer
    from vtkmodules.vtkIOExodus import vtkExodusIIWriter

    source, writer = vtkTrivialProducer(), vtkExodusIIWriter()
    source.SetOutput(with_cells(0.0))
    writer.SetInputConnection(source.GetOutputPort())
    writer.SetFileName(str(tmp_path / "wall.e"))
    writer.Write()
    status, out, err = run(capsys, "analyze", tmp_path / "wall.e", "--json", "-")
    assert status == 0, err
    assert len(json.loads(out)["fixed_points"]) == 6


def test_info_lists_the_times(capsys, tmp_path):
    entries = [(time, 0, file.name) for time, file in zip(TIMES, files(tmp_path), strict=True)]
    status, out, _ = run(capsys, "info", write_pvd(tmp_path / "wall.pvd", entries))
    content = json.loads(out)
    assert status == 0 and content["read"]["times"] == TIMES and np.allclose(content["lam"], LAMBDAS)


# A surface that is not the same at all times --------------------------------------------------------------------------


def test_a_wall_that_moves_a_little_is_the_first_one_and_that_is_said(capsys, tmp_path):
    for k, time in enumerate(TIMES):
        write_vtk(tmp_path / f"w_{k}.vtp", wall(time, (1 + 0.01 * k) * POINTS, stamp=time))
    content = tracking(capsys, tmp_path)
    assert_followed(content)
    assert "the surface moves by up to" in content["read"]["notes"][0]


def test_vectors_of_a_wall_that_turns_turn_back_with_it(tmp_path):
    """A rigid motion carries the field along: on the first surface it rests."""
    from stormfield.readers import read_field

    angle = 0.05
    turned = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    for k, motion in enumerate((np.eye(3), turned)):
        data = poly_data(POINTS @ motion.T, TRIANGLES, {"WSS": flow(POINTS) @ motion.T})
        write_vtk(tmp_path / f"w_{k}.vtp", data)
    data = read_field(tmp_path)
    normals = POINTS
    assert np.abs(np.einsum("ij,ij->i", data.vectors[1], normals)).max() < 1e-2
    assert np.abs(data.vectors[1] - data.vectors[0]).max() < 0.06


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: poly_data(POINTS, TRIANGLES[:-1], {"WSS": flow(POINTS)}), "other faces than"),
        (lambda data: wall(1.0, name="U"), "has no array 'WSS'"),
        (lambda data: wall(1.0, 2 * POINTS), "the surface moves by"),
        (lambda data: wall(np.nan), "not finite"),
    ],
)
def test_other_surfaces_and_missing_arrays_name_the_file(capsys, tmp_path, change, words):
    paths = files(tmp_path)
    write_vtk(paths[4], change(None))
    line = refused(capsys, "track", tmp_path, "--json", "-")
    assert words in line and ("wall_0004.vtp" in line or "moves" in words)


def test_times_that_come_twice_and_collections_that_are_broken(capsys, tmp_path):
    paths = files(tmp_path / "w")
    missing = write_pvd(tmp_path / "a.pvd", [(0, 0, "gone.vtp")])
    assert "gone.vtp" in refused(capsys, "track", missing, "--json", "-")
    (tmp_path / "b.pvd").write_text("<VTKFile>")
    assert "b.pvd: is not a .pvd" in refused(capsys, "track", tmp_path / "b.pvd", "--json", "-")
    empty = write_pvd(tmp_path / "c.pvd", [])
    assert "names no files" in refused(capsys, "track", empty, "--json", "-")
    for path in paths:
        write_vtk(path, wall(0.0, stamp=1.0))
    assert "time 1 follows 1" in refused(capsys, "track", tmp_path / "w", "--json", "-")


def test_a_folder_of_several_data_sets_is_not_guessed_at(capsys, tmp_path):
    files(tmp_path)
    files(tmp_path, names="inlet_{:04d}")
    line = refused(capsys, "track", tmp_path, "--json", "-")
    assert "several data sets, inlet_#.vtp, wall_#.vtp" in line
    assert_followed(tracking(capsys, tmp_path / "wall_*.vtp"), np.linspace(0, 1, 6))
    (tmp_path / "none").mkdir()
    assert "has no data" in refused(capsys, "track", tmp_path / "none", "--json", "-")
    assert "no file has such a name" in refused(capsys, "track", tmp_path / "x_*.vtp", "--json", "-")


def test_one_time_is_not_tracked(capsys, tmp_path):
    path = write_mesh(tmp_path / "wall.vtu", POINTS, TRIANGLES, point_data={"WSS": flow(POINTS)})
    assert "one sample" in refused(capsys, "track", path, "--json", "-")
