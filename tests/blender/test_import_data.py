# SPDX-License-Identifier: GPL-3.0-or-later
"""File → Import → Stormfield Data: globes, regions with coasts, surfaces and caches as objects with a field."""

import bpy
import numpy as np
import pytest
from modal import in_slices
from stormfield.scene.read.attached import LAMBDA, attached_folder

AXIS = np.array([3.0, -5.0, 8.0])


@pytest.fixture
def wind(tmp_path):
    """A file of a rotation that doubles in a day, with land where asked for."""
    xarray = pytest.importorskip("xarray")

    def write(land=False, times=3):
        latitude, longitude = np.arange(-90.0, 91.0, 5.0), np.arange(0.0, 360.0, 5.0)
        phi, theta = np.meshgrid(np.radians(latitude), np.radians(longitude), indexing="ij")
        place = np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)], -1)
        east = np.stack([-np.sin(theta), np.cos(theta), 0 * phi], -1)
        north = np.stack([-np.sin(phi) * np.cos(theta), -np.sin(phi) * np.sin(theta), np.cos(phi)], -1)
        flow = np.cross(AXIS, place)
        growth = np.linspace(1.0, 2.0, times)[:, None, None]
        u, v = growth * (flow * east).sum(-1), growth * (flow * north).sum(-1)
        if land:
            u[:, 20:26, 10:20] = np.nan
        dims = ("time", "latitude", "longitude")
        data = xarray.Dataset(
            {"u10": (dims, u, {"units": "m s-1"}), "v10": (dims, v, {"units": "m s-1"})},
            {
                "time": ("time", np.linspace(0.0, 24.0, times), {"units": "hours since 2018-10-06"}),
                "latitude": latitude,
                "longitude": longitude,
            },
        )
        data.to_netcdf(tmp_path / "wind.nc")
        return str(tmp_path / "wind.nc")

    return write


def shown(obj, name="sf_advection"):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = np.empty(len(evaluated.vertices) * 3, np.float32)
    evaluated.attributes[name].data.foreach_get("vector", values)
    return values.reshape(-1, 3).astype(float)


def places(obj):
    values = np.empty(len(obj.data.vertices) * 3, np.float32)
    obj.data.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(float)


def test_wind_is_a_globe_in_the_time_of_the_scene(native, wind, scene):
    """A day in 50 frames at 25 a second: 1.96 s, so that speeds are 44,082 times those of the data."""
    scene.render.fps = 25
    assert bpy.ops.stormfield.import_data(filepath=wind()) == {"FINISHED"}
    obj = bpy.context.object
    assert obj.stormfield.enabled and obj.name == "wind"
    assert np.allclose(np.linalg.norm(places(obj), axis=1), 1.0, atol=1e-5)
    factor = 86400.0 / (49 / 25) / 6371000.0
    for frame, growth in ((1, 1.0), (50, 2.0)):
        scene.frame_set(frame)
        exact = growth * factor * np.cross(AXIS, places(obj))
        assert np.abs(shown(obj) - exact).max() < 0.01 * np.abs(exact).max()
    assert list(obj["stormfield_times"]) == ["2018-10-06T00:00:00", "2018-10-07T00:00:00"]
    assert "u10" in obj["stormfield_read"]
    assert not obj.children
    assert bpy.ops.stormfield.analyze_lambda() == {"FINISHED"}
    assert bpy.ops.stormfield.streamlines() == {"FINISHED"}


def test_coasts_are_a_curve_and_the_ground_is_seen(native, wind):
    assert bpy.ops.stormfield.import_data(filepath=wind(land=True), radius=2.0) == {"FINISHED"}
    obj = bpy.context.object
    kinds = {child.type: child for child in obj.children}
    assert kinds.keys() == {"CURVE", "MESH"}
    assert len(kinds["CURVE"].data.splines) == 1
    assert np.allclose(np.linalg.norm(places(obj), axis=1), 2.0, atol=1e-5)


def test_a_region_has_its_border_apart_from_its_coasts(native, tmp_path):
    xarray = pytest.importorskip("xarray")
    latitude, longitude = np.arange(0.0, 31.0, 2.0), np.arange(270.0, 311.0, 2.0)
    u = np.ones((len(latitude), len(longitude)))
    u[5:9, 8:12] = np.nan
    dims = ("latitude", "longitude")
    data = xarray.Dataset(
        {n: (dims, u, {"units": "m s-1"}) for n in ("u10", "v10")}, {"latitude": latitude, "longitude": longitude}
    )
    data.to_netcdf(tmp_path / "gulf.nc")
    assert bpy.ops.stormfield.import_data(filepath=str(tmp_path / "gulf.nc")) == {"FINISHED"}
    children = {child.name: child for child in bpy.context.object.children}
    assert children.keys() == {"gulf Coasts", "gulf Border", "gulf Ground"}
    assert all(len(children[f"gulf {what}"].data.splines) == 1 for what in ("Coasts", "Border"))


def test_times_are_chosen_and_one_time_is_still(native, wind):
    path = wind()
    assert bpy.ops.stormfield.import_data(filepath=path, first="2018-10-06T12") == {"FINISHED"}
    obj = bpy.context.object
    ratio = shown(obj) / np.maximum(np.abs(shown(obj)).max(), 1e-9)
    exact = np.cross(AXIS, places(obj))
    assert np.abs(ratio - exact / np.abs(exact).max()).max() < 0.02


def test_a_surface_keeps_its_size(native, tmp_path):
    rows = ["4 4", "0 1 2", "0 3 1", "1 3 2", "0 2 3"]
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    rows += [" ".join(map(str, row)) for row in (*corners, *np.cross(AXIS, corners - 0.25))]
    (tmp_path / "a.t").write_text("\n".join(rows))
    assert bpy.ops.stormfield.import_data(filepath=str(tmp_path / "a.t")) == {"FINISHED"}
    assert np.allclose(places(bpy.context.object), corners)


def test_a_cache_is_shown_where_it_is(native, wind, tmp_path):
    """As the command line makes it, for a Blender that lacks the packages."""
    from stormfield.cli import main

    assert main(["import", wind(), "--out", str(tmp_path / "cache"), "--seconds", "2"]) == 0
    file = next((tmp_path / "cache").glob("field.usd*"))
    assert bpy.ops.stormfield.import_data(filepath=str(file)) == {"FINISHED"}
    obj = bpy.context.object
    assert attached_folder(obj, LAMBDA) == tmp_path / "cache"
    exact = 86400.0 / 2.0 / 6371000.0 * np.cross(AXIS, places(obj))
    assert np.abs(shown(obj) - exact).max() < 0.01 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("name", "words"), [("absent.nc", "no such file"), ("bad.nc", "is not a grid"), ("bad.t", "does not begin")]
)
def test_what_cannot_be_read_is_refused_and_leaves_nothing(native, tmp_path, name, words):
    if name.startswith("bad"):
        (tmp_path / name).write_bytes(b"nonsense")
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.stormfield.import_data(filepath=str(tmp_path / name))
    assert not bpy.data.objects


@pytest.mark.parametrize(
    ("name", "content", "package"), [("a.grib", b"GRIB", "cfgrib"), ("a.nc", b"\x89HDF\r\n\x1a\n", "netCDF4")]
)
def test_a_package_that_this_blender_lacks_is_named(native, tmp_path, monkeypatch, name, content, package):
    (tmp_path / name).write_bytes(content)
    monkeypatch.setattr("stormfield.readers.grids.opening.importlib.util.find_spec", lambda _name: None)
    with pytest.raises(RuntimeError, match=rf"needs the Python package {package}.*stormfield import"):
        bpy.ops.stormfield.import_data(filepath=str(tmp_path / name))
    assert not bpy.data.objects


def test_the_command_line_bakes_an_imported_field_and_solves_nothing(native, wind, tmp_path, scene, capsys):
    from stormfield.cli import main

    scene.frame_end = 3
    assert bpy.ops.stormfield.import_data(filepath=wind(), sphere_faces=1280) == {"FINISHED"}
    obj = bpy.context.object
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "globe.blend"))
    before = shown(obj)
    assert main(["bake", str(tmp_path / "globe.blend"), "--targets", "usd", "--save"]) == 0
    obj = bpy.data.objects["wind"]
    assert "usd" in capsys.readouterr().out
    bpy.context.scene.frame_set(1)
    assert np.abs(shown(obj) - before).max() < 1e-6
    assert np.isfinite(shown(obj, "sf_phase_a")).all()


def blocks():
    """All that an import may leave."""
    kinds = ("objects", "meshes", "curves", "materials", "actions", "cache_files", "node_groups")
    return {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in kinds}


def test_in_the_window_it_works_in_slices_and_esc_leaves_nothing(native, wind):
    """Esc after every number of slices, until one comes too late."""
    from stormfield.operators.import_data import STORMFIELD_OT_import_data as IMPORT
    from stormfield.session import running

    before, options = blocks(), {"filepath": wind(land=True), "sphere_faces": 1280, "slice_seconds": 0.0}
    stopped, messages = 0, []
    while (end := in_slices(IMPORT, stop_after=stopped, messages=messages, **options)) == {"CANCELLED"}:
        assert blocks() == before and running.current() is None
        stopped += 1
    assert end == {"FINISHED"} and stopped > 10
    assert {"Opening wind.nc", "Reading time 2 of 3", "Making the mesh"} <= set(messages)
    assert bpy.context.object.name == "wind" and bpy.context.object.stormfield.enabled


def test_in_slices_and_in_one_call_it_makes_the_same(native, wind):
    from stormfield.operators.import_data import STORMFIELD_OT_import_data as IMPORT

    path = wind(land=True)
    assert in_slices(IMPORT, filepath=path) == {"FINISHED"}
    one = bpy.context.object
    assert bpy.ops.stormfield.import_data(filepath=path) == {"FINISHED"}
    two = bpy.context.object
    assert (one.name, two.name) == ("wind", "wind.001")
    assert np.array_equal(places(one), places(two)) and np.array_equal(shown(one), shown(two))
    folders = [attached_folder(obj, LAMBDA) for obj in (one, two)]
    assert folders[0].name == folders[1].name and folders[0].parent != folders[1].parent


def test_faults_of_the_file_are_told_from_the_slices(native, tmp_path):
    from stormfield.operators.import_data import STORMFIELD_OT_import_data as IMPORT

    (tmp_path / "bad.t").write_text("nonsense")
    reports = []
    assert in_slices(IMPORT, filepath=str(tmp_path / "bad.t"), reports=reports) == {"CANCELLED"}
    assert "does not begin" in reports[0] and not bpy.data.objects


def test_undo_removes_all_of_it_in_one_step(native, wind):
    bpy.ops.ed.undo_push(message="before")
    before = blocks()
    assert bpy.ops.stormfield.import_data(filepath=wind(land=True)) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    after = blocks()
    bpy.ops.ed.undo()
    assert blocks() == before
    bpy.ops.ed.redo()
    assert blocks() == after and np.isfinite(shown(bpy.data.objects["wind"])).all()


def test_a_cache_of_other_polygons_than_triangles_is_shown(native, plane_of_quads):
    """As Blender itself solves it: the cache holds the quads."""
    folder = attached_folder(plane_of_quads, LAMBDA)
    assert bpy.ops.stormfield.import_data(filepath=str(folder / "manifest.json")) == {"FINISHED"}
    obj = bpy.context.object
    assert obj != plane_of_quads
    assert np.abs(shown(obj) - shown(plane_of_quads)).max() < 1e-6


@pytest.fixture
def plane_of_quads(native):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=2.0)
    obj = bpy.context.object
    attribute = obj.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    flow = np.cross([0.0, 0.0, 1.0], places(obj))
    flow[:, 0] += 0.2
    attribute.data.foreach_set("vector", flow.astype(np.float32).ravel())
    assert bpy.ops.stormfield.field_from_attribute(attribute="velocity") == {"FINISHED"}
    return obj
