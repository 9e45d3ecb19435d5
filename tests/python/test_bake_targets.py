# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole pipeline without Blender's scene: design → λ cache → EXR and VDB, resumable at every step."""

import time
from dataclasses import replace

import numpy as np
import pytest
from stormfield import native
from stormfield.bake.job import bake_steps
from stormfield.bake.lambda_cache import is_warm_started, solve_steps
from stormfield.bake.targets.exr import check_half, write_image
from stormfield.bake.targets.vdb import write_volume
from stormfield.bake.task import BakeTask, ExrSettings, FlowSettings, VdbSettings
from stormfield.cache import fields
from stormfield.cache.field_cache import open_cache
from stormfield.model.design import Design, Element, SolveSettings
from stormfield.model.errors import InputError
from stormfield.model.mesh_data import MeshData
from stormfield.readers.icosphere import icosphere
from stormfield.solve import SolverState, start_solve
from stormfield.work import POLL, run
from test_cache import contents

DESIGN = Design(
    elements=(
        Element("west", "singular", ((1, 0, 0.3), (0.8, 0.6, 0)), kind="vortex_ccw", radius=0.4),
        Element("east", "singular", ((-1, 0, 0.3),), kind="spiral_in_cw", radius=0.4, field="advection"),
        Element("drift", "regular", ((0, 1, 0), (0, 1, 0.3)), radius=0.3, field="orientation"),
    ),
    settings=SolveSettings(samples=5),
)


@pytest.fixture(scope="module")
def mesh():
    """A sphere whose UV layer is the map from above (overlapping) and one that leaves the lower half out."""
    sphere = icosphere(500)
    corners = sphere.vertices[sphere.triangles]
    above = (0.5 + 0.45 * corners[:, :, :2]).astype(np.float32)
    upper = np.where((corners[:, :, 2].min(axis=1) >= 0)[:, None, None], above, np.float32(0.1))
    return MeshData(sphere.vertices, sphere.triangles, {"above": above, "upper": upper})


@pytest.fixture(scope="module")
def solved(mesh, tmp_path_factory):
    return run(solve_steps(mesh, DESIGN, tmp_path_factory.mktemp("root")))


@pytest.fixture
def task(mesh, solved, tmp_path):
    return BakeTask(
        cache=solved,
        mesh=mesh,
        frames=(1, 2, 3, 4),
        lambdas=(0.0, 0.3, 0.6, 1.0),
        root=tmp_path,
        targets=frozenset({"exr", "vdb"}),
        exr=ExrSettings(uv_layer="upper", resolution=64),
        vdb=VdbSettings(voxel_size=0.1),
    )


# Solve ----------------------------------------------------------------------------------------------------------------


def test_a_solve_is_a_cache_of_its_own_design(mesh, solved):
    cache = open_cache(solved)
    cache.check_mesh(mesh)
    assert np.array_equal(cache.lambdas, np.linspace(0, 1, 5))
    assert Design.from_json(cache.settings["design"]) == DESIGN
    sample = cache.sample(2)
    assert {"sf_orientation", "sf_advection", "sf_speed"} <= sample.keys()
    assert np.allclose(sample["sf_speed"], np.linalg.norm(sample["sf_advection"], axis=1), rtol=1e-5)
    assert not np.allclose(sample["sf_orientation"], sample["sf_advection"])
    normals = native.TriangleMesh(mesh.vertices, mesh.triangles).normals
    assert np.abs(np.einsum("ij,ij->i", sample["sf_advection"], normals)).max() < 1e-6


def test_the_same_design_is_found_again_and_another_gets_another_folder(mesh, solved, monkeypatch):
    before = contents(solved)
    with monkeypatch.context() as patch:
        patch.setattr("stormfield.bake.lambda_cache.start_solve", lambda *a: pytest.fail("solved again"))
        assert run(solve_steps(mesh, DESIGN, solved.parent)) == solved
    assert contents(solved) == before
    other = replace(DESIGN, settings=SolveSettings(samples=3))
    folder = run(solve_steps(mesh, other, solved.parent))
    assert folder != solved and folder.parent == solved.parent
    assert contents(solved) == before


def stopped_after(steps, count):
    """Runs `count` steps that do something, waiting for the core in between, and stops; whether it came to the end."""
    try:
        for step in steps:
            assert 0.0 <= step.fraction <= 1.0 and step.message
            if step.waiting:
                time.sleep(POLL)
            elif count == 0:
                return False
            else:
                count -= 1
        return True
    finally:
        steps.close()


def test_a_solve_stopped_at_any_step_resumes_to_the_same_bytes(mesh, solved, tmp_path):
    count = 1
    while not stopped_after(solve_steps(mesh, DESIGN, tmp_path), count):
        count += 1
    assert count > 3
    (folder,) = tmp_path.iterdir()
    assert contents(folder) == contents(solved)


def test_a_solve_stopped_while_the_core_works_leaves_no_samples(mesh, tmp_path):
    steps = solve_steps(mesh, replace(DESIGN, settings=SolveSettings(samples=400)), tmp_path)
    assert any(step.waiting for step in steps)
    steps.close()
    (folder,) = tmp_path.iterdir()
    assert set(contents(folder)) == {"plan.json"}


def test_samples_are_waited_for_in_order_and_given_up_when_the_writer_stops(mesh, solved, ending):
    solution = start_solve(mesh, replace(DESIGN, settings=SolveSettings(samples=60))).result()
    samples = [each for each in fields.attributes_of(solution) if each is not None]
    assert len(samples) == 60
    for j in (0, 15, 16, 59):
        vectors = solution.fields["advection"].sample(j).to_space().astype(np.float32)
        np.testing.assert_array_equal(samples[j][fields.ADVECTION], vectors)
    stopped = fields.attributes_of(solution)
    while next(stopped) is None:
        pass
    stopped.close()
    assert not ending or ending[-1][0].cancelled  # the next block, unless it was there already


def test_fractions_never_go_back(mesh, tmp_path):
    fractions = [step.fraction for step in solve_steps(mesh, DESIGN, tmp_path)]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0


def moved(step: int) -> Design:
    """DESIGN as it is after some edits."""
    elements = tuple(replace(element, radius=element.radius + 0.02 * step) for element in DESIGN.elements)
    return replace(DESIGN, elements=elements)


def test_edited_caches_have_folders_of_their_own_and_are_solved_from_zero_before_a_bake(mesh, task, tmp_path):
    state = SolverState()
    first = run(solve_steps(mesh, moved(0), tmp_path, state=state))
    edited = run(solve_steps(mesh, moved(1), tmp_path, state=state))
    other = run(solve_steps(mesh, moved(1), tmp_path))
    assert not is_warm_started(first) and is_warm_started(edited) and not is_warm_started(other)
    assert edited != other
    # What is solved from zero is there now, and is taken instead.
    assert run(solve_steps(mesh, moved(1), tmp_path, state=state)) == other
    one, two = (open_cache(folder).values("sf_orientation") for folder in (edited, other))
    # Both within the tolerance, which speaks of the residual: values far from the elements may differ by more.
    np.testing.assert_allclose(one, two, atol=0.1 * np.abs(two).max())
    results = [
        run(bake_steps(replace(task, cache=folder, root=tmp_path / name, targets=frozenset({"exr"}))))
        for folder, name in ((edited, "a"), (other, "b"))
    ]
    assert [result.cache for result in results] == [other, other]
    files = [sorted((result.folders["exr"] / "frames").iterdir()) for result in results]
    assert [path.read_bytes() for path in files[0]] == [path.read_bytes() for path in files[1]]


# Targets --------------------------------------------------------------------------------------------------------------


def read_exr(path):
    """Pixels (height, width, 4) and header through Blender's OpenImageIO."""
    bpy = pytest.importorskip("bpy")
    bpy.utils.expose_bundled_modules()
    import OpenImageIO

    image = OpenImageIO.ImageInput.open(str(path))
    attributes = {attribute.name: attribute.value for attribute in image.spec().extra_attribs}
    return np.asarray(image.read_image("float")), attributes


def test_flow_maps_hold_the_field_and_say_what_they_are(task, mesh):
    result = run(bake_steps(replace(task, targets=frozenset({"exr"}))))
    assert result.whole and any("no area" in remark for remark in result.remarks)
    pixels, header = read_exr(result.folders["exr"] / "frames/frame_0002.exr")
    assert header["stormfield:basis"] == "uv"
    assert header["stormfield:lambda"] == "0.3"
    assert header["stormfield:mesh"] == mesh.fingerprint()
    assert "UV units per second" in header["stormfield:channels"]
    # At the centre of the map is the pole, where u, v are 0.45 x, 0.45 y.
    sample = open_cache(task.cache).at(0.3)["sf_advection"]
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    field = native.VectorField.from_space(surface, sample.astype(float))
    x, y = 36, 28
    u, v = (x + 0.5) / 64, 1 - (y + 0.5) / 64
    place = np.array([[(u - 0.5) / 0.45, (v - 0.5) / 0.45, 1.0]])
    place[0, 2] = np.sqrt(1 - place[0, 0] ** 2 - place[0, 1] ** 2)
    vector = field.evaluate(*surface.closest_points(place)[:2])[0]
    assert np.allclose(pixels[y, x, :2], 0.45 * vector[:2], atol=0.03 * np.linalg.norm(vector))
    assert np.isclose(pixels[y, x, 2], np.linalg.norm(vector), rtol=0.03)
    assert pixels[y, x, 3] == 1.0 and pixels[0, 0, 3] == 0.0


def test_sixteen_bits_and_object_space(task):
    exr = ExrSettings(uv_layer="upper", resolution=32, basis="object", half=True, field="orientation")
    result = run(bake_steps(replace(task, targets=frozenset({"exr"}), exr=exr)))
    pixels, header = read_exr(result.folders["exr"] / "frames/frame_0001.exr")
    assert header["stormfield:field"] == "orientation"
    assert np.abs(pixels[16, 16, 2]) < 0.1 * np.abs(pixels[16, 16, :2]).max()  # tangent at the pole


def test_an_overlapping_layer_is_reported(task):
    exr = ExrSettings(uv_layer="above", resolution=32)
    result = run(bake_steps(replace(task, targets=frozenset({"exr"}), exr=exr)))
    assert any("overlaps itself" in remark for remark in result.remarks)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"exr": ExrSettings(uv_layer="nope")}, "no UV layer 'nope'; choose one of 'above', 'upper'"),
        ({"exr": ExrSettings(basis="polar")}, "basis"),
        ({"exr": ExrSettings(field="curl")}, "field 'curl'"),
        ({"exr": ExrSettings(resolution=0)}, "pixels"),
        ({"vdb": VdbSettings(voxel_size=1e-6)}, "million voxels"),
        ({"targets": frozenset({"abc"})}, "unknown target 'abc'"),
        ({"only": frozenset({3, 9})}, "frame 9 is outside the bake, 1 to 4"),
        ({"frames": (1, 2)}, "λ at each"),
    ],
)
def test_bad_tasks_are_refused(task, change, words):
    with pytest.raises((InputError, native.InputError), match=words):
        run(bake_steps(replace(task, **change)))


def test_a_mesh_without_uv_layer_and_a_foreign_mesh_are_refused(task, mesh):
    bare = MeshData(mesh.vertices, mesh.triangles)
    with pytest.raises(InputError, match=r"needs? a UV layer"):
        run(bake_steps(replace(task, mesh=bare)))
    foreign = MeshData(mesh.vertices * 1.5, mesh.triangles, mesh.uv_layers)
    with pytest.raises(InputError, match="another mesh"):
        run(bake_steps(replace(task, mesh=foreign)))


def openvdb():
    pytest.importorskip("bpy").utils.expose_bundled_modules()
    import openvdb as module

    return module


def voxels(grid):
    return {tuple(voxel.min): voxel.value for voxel in grid.citerOnValues()}


def test_volumes_hold_the_band_alone_and_zeros_within_it(mesh, tmp_path):
    """Values that equal the background must stay: here the field is zero on half of the surface."""
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    vectors = np.where(mesh.vertices[:, :1] > 0, np.cross(mesh.vertices, [0.0, 0.0, 1.0]), 0.0)
    band = native.VoxelBand(surface, 0.1, 2.5)
    path = tmp_path / "band.vdb"
    fields = {"sf_advection": native.VectorField.from_space(surface, vectors)}
    fractions = list(write_volume(path, band, fields, {"stormfield:note": "a"}))
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    grids, metadata = openvdb().readAll(str(path))
    assert metadata == {"stormfield:note": "a"}
    found = {grid.name: grid for grid in grids}
    assert found.keys() == {"sf_advection", "sf_speed", "sf_distance"}
    for grid in grids:
        assert grid.activeVoxelCount() == band.voxel_count
        assert grid.transform.voxelSize() == (0.1, 0.1, 0.1)
    assert found["sf_advection"].background == (0.0, 0.0, 0.0) and found["sf_speed"].background == 0.0
    assert found["sf_advection"].vectorType == "contravariant relative"
    assert sum(value == (0.0, 0.0, 0.0) for value in voxels(found["sf_advection"]).values()) > 100
    speeds = voxels(found["sf_speed"])
    assert all(np.isclose(speeds[at], np.linalg.norm(v), atol=1e-6) for at, v in voxels(found["sf_advection"]).items())
    assert min(voxels(found["sf_distance"]).values()) < 0.0 and found["sf_distance"].gridClass == "level set"


def test_open_surfaces_have_distances_without_sign(tmp_path):
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    surface = native.TriangleMesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    list(write_volume(tmp_path / "open.vdb", native.VoxelBand(surface, 0.1, 2.0), {}, {}))
    (distance,) = openvdb().readAll(str(tmp_path / "open.vdb"))[0]
    assert min(voxels(distance).values()) >= 0.0 and distance.gridClass == "unknown"


def test_distances_are_those_of_openvdbs_own_level_set(tmp_path):
    ball = icosphere(1000)
    points, triangles = ball.vertices.astype(np.float32), ball.triangles
    surface = native.TriangleMesh(points.astype(float), triangles)
    band = native.VoxelBand(surface, 0.05, 3.0)
    path = tmp_path / "ball.vdb"
    list(write_volume(path, band, {}, {}))
    (ours,) = openvdb().readAll(str(path))[0]
    theirs = openvdb().FloatGrid.createLevelSetFromPolygons(
        points, triangles=triangles.astype(np.uint32), transform=openvdb().createLinearTransform(0.05), halfWidth=3.0
    )
    assert ours.gridClass == "level set" and ours.background == theirs.background
    a, b = voxels(ours), voxels(theirs)
    # OpenVDB smooths its distances by some hundredths of a voxel, so that voxels at the edge of the band differ; ours
    # are exact (HoldsExactlyTheVoxelsNearTheSurface).
    smoothed = 0.2 * 0.05
    both = a.keys() & b.keys()
    assert max(abs(a[at] - b[at]) for at in both) < smoothed
    assert all(abs((a | b)[at]) > 3.0 * 0.05 - smoothed for at in a.keys() ^ b.keys())
    inside = ours.getConstAccessor()
    assert inside.getValue((0, 0, 0)) == -ours.background and inside.getValue((100, 0, 0)) == ours.background


def test_equal_volumes_have_equal_bytes_and_others_another_identifier(mesh, tmp_path):
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    band = native.VoxelBand(surface, 0.2, 2.0)

    def written(name, note):
        list(write_volume(tmp_path / name, band, {}, {"note": note}))
        return (tmp_path / name).read_bytes()

    assert written("a.vdb", "x") == written("b.vdb", "x")
    assert written("a.vdb", "x")[21:57] != written("c.vdb", "y")[21:57]


def test_images_come_back_bit_for_bit_with_their_metadata(tmp_path):
    image = (np.sin(np.arange(60, dtype=np.float32)) * 1e-3).reshape(3, 5, 4)
    for half in (False, True):
        list(write_image(tmp_path / "a.exr", image, {"stormfield:basis": "uv"}, half=half))
        list(write_image(tmp_path / "b.exr", image, {"stormfield:basis": "uv"}, half=half))
        assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
        pixels, header = read_exr(tmp_path / "a.exr")
        assert np.array_equal(pixels, image.astype(np.float16).astype(np.float32) if half else image)
        assert header["stormfield:basis"] == "uv"
        assert header["DateTime"] == "1970:01:01 00:00:00"  # not the present


def test_sixteen_bits_refuse_what_they_cannot_hold():
    image = np.zeros((2, 3, 4), np.float32)
    image[1, 2, 1] = 1e6
    with pytest.raises(InputError, match=r"pixel \(2, 1\) holds 1e\+06"):
        check_half(image)
    image[1, 2, 1] = 65504.0
    check_half(image)


def test_files_that_cannot_be_written_are_named(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        list(write_image(tmp_path / "nowhere" / "a.exr", np.zeros((2, 2, 4), np.float32), {}, half=False))


def test_volumes_are_read_by_blenders_openvdb(task, mesh):
    bpy = pytest.importorskip("bpy")
    result = run(bake_steps(replace(task, targets=frozenset({"vdb"}))))
    bpy.utils.expose_bundled_modules()
    import openvdb

    grids, metadata = openvdb.readAll(str(result.folders["vdb"] / "frames/frame_0003.vdb"))
    assert {grid.name for grid in grids} == {"sf_orientation", "sf_advection", "sf_speed", "sf_distance"}
    assert metadata["stormfield:lambda"] == "0.6"
    assert metadata["stormfield:mesh"] == mesh.fingerprint()
    (advection,) = (grid for grid in grids if grid.name == "sf_advection")
    sample = open_cache(task.cache).at(0.6)["sf_advection"]
    surface = native.TriangleMesh(mesh.vertices, mesh.triangles)
    field = native.VectorField.from_space(surface, sample.astype(float))
    place = np.array(advection.transform.indexToWorld((8, 4, 5)))
    expected = field.evaluate(*surface.closest_points(place[None])[:2])[0]
    assert np.allclose(advection.getConstAccessor().getValue((8, 4, 5)), expected, atol=1e-6)


ALL = frozenset({"usd", "exr", "vdb"})


def test_the_frame_cache_holds_the_flowing_coordinates(task, mesh):
    result = run(bake_steps(replace(task, targets=frozenset({"usd"}), flow=FlowSettings(period=8))))
    cache = open_cache(result.folders["usd"])
    assert np.array_equal(cache.frames, [1, 2, 3, 4])
    sample = cache.sample(2)
    assert sample.keys() == {"sf_phase_a", "sf_phase_b", "sf_blend"}
    assert sample["sf_phase_a"].shape == (len(mesh.vertices), 3)
    assert sample["sf_blend"].min() >= 0.0 and sample["sf_blend"].max() <= 1.0
    again = run(bake_steps(replace(task, targets=frozenset({"usd"}), flow=FlowSettings(period=9))))
    assert again.folders["usd"] != result.folders["usd"]


def test_any_split_of_the_frames_gives_the_same_bytes(task, tmp_path):
    task = replace(task, targets=ALL)
    whole = run(bake_steps(replace(task, root=tmp_path / "whole")))
    split = replace(task, root=tmp_path / "split")
    first = run(bake_steps(replace(split, only=frozenset({2, 3}))))
    assert not first.whole
    assert not (first.folders["exr"] / "manifest.json").exists()
    second = run(bake_steps(replace(split, only=frozenset({1, 4}))))
    assert second.whole
    for target in ALL:
        assert contents(whole.folders[target]) == contents(second.folders[target])


def test_a_bake_stopped_at_any_step_resumes_to_the_same_bytes(task, tmp_path):
    task = replace(task, targets=ALL)
    expected = run(bake_steps(replace(task, root=tmp_path / "whole")))
    stopped = replace(task, root=tmp_path / "stopped")
    count = 1
    while not stopped_after(bake_steps(stopped), count):
        count += 1
    result = run(bake_steps(stopped))
    for target in ALL:
        assert contents(result.folders[target]) == contents(expected.folders[target])


def only_folder(task, target):
    """The folder of the one bake of a target."""
    (folder,) = task.root.glob(f"{target}-*")
    return folder


def closed_at(steps, wanted):
    """Runs until a step is wanted, and closes there."""
    for step in steps:
        if wanted(step):
            steps.close()
            return
        if step.waiting:
            time.sleep(0.001)
    pytest.fail("came to its end before")


#: Each takes about a second to prepare, and longer than a look to draw.
LARGE = {"exr": {"exr": ExrSettings(uv_layer="upper", resolution=2048)}, "vdb": {"vdb": VdbSettings(voxel_size=0.01)}}
WORDS = {"exr": ("Reading the UV layer", "Drawing the flow map"), "vdb": ("Finding the voxels", "Writing the volume")}
#: Largest fraction of a job of the core that is still done when it was cancelled.
SOON = 0.25


def works(step, words, fraction=0.0):
    """Whether a step is within the work that its message names, beyond its announcement."""
    return step.message.startswith(words) and step.fraction > fraction


@pytest.mark.parametrize("target", ["exr", "vdb"])
def test_closing_stops_the_core_at_once_and_leaves_nothing_of_the_file_in_work(task, target, ending):
    large = replace(task, targets=frozenset({target}), **LARGE[target])
    preparing, drawing = WORDS[target]
    # Five parts: preparing, then four frames.
    for part in (0.0, 0.04, 0.12):
        closed_at(bake_steps(large), lambda step, part=part: works(step, preparing, part))
        assert set(contents(only_folder(task, target))) == {"plan.json"}
    # One frame becomes finished, and stays.
    closed_at(bake_steps(large), lambda step: works(step, drawing, 0.4))
    finished = contents(only_folder(task, target))
    assert set(finished) == {"plan.json", f"frames/frame_0001.{target}", f"frames/frame_0001.{target}.sha256"}
    # Three are left; the next one is worked on from 0.25 to 0.5.
    for part in (0.25, 0.35):
        closed_at(bake_steps(large), lambda step, part=part: works(step, drawing, part))
        assert contents(only_folder(task, target)) == finished
    assert ending  # what Python does itself ends between two steps
    for job, done in ending:
        with pytest.raises(native.Cancelled):
            job.result()
        assert job.fraction <= done + SOON


@pytest.mark.parametrize("target", ["exr", "vdb"])
def test_closing_between_two_slices_of_a_file_removes_it(task, target, monkeypatch, tmp_path):
    small = replace(task, targets=frozenset({target}))
    expected = contents(run(bake_steps(replace(small, root=tmp_path / "whole"))).folders[target])
    monkeypatch.setattr("stormfield.cache.store.SLICE", 1000)
    second = f"frame {small.frames[1]}"
    slices = [0]

    def third_slice(step):
        slices[0] += not step.waiting and step.message.endswith(second)
        return slices[0] == 4  # the first step announces the frame

    closed_at(bake_steps(small), third_slice)
    left = contents(only_folder(task, target))
    assert {name.removesuffix(".sha256") for name in left} == {"plan.json", f"frames/frame_0001.{target}"}
    assert contents(run(bake_steps(small)).folders[target]) == expected


def test_changed_settings_get_a_folder_of_their_own(task):
    first = run(bake_steps(replace(task, targets=frozenset({"exr"}))))
    before = contents(first.folders["exr"])
    smaller = ExrSettings(uv_layer="upper", resolution=32)
    second = run(bake_steps(replace(task, targets=frozenset({"exr"}), exr=smaller)))
    after = contents(second.folders["exr"])
    assert before.keys() == after.keys() and all(before[name] != after[name] for name in before)
    assert contents(first.folders["exr"]) == before
