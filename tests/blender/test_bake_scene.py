# SPDX-License-Identifier: GPL-3.0-or-later
"""stormfield bake SCENE.blend: the scene's bakes without its window."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from stormfield.cli import main


def contents(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


@pytest.fixture
def file(storms, scene, tmp_path):
    """The two storms with λ keyed over frames 1 to 6 and a UV layer, saved."""
    scene.frame_end = 6
    for frame, lam in ((1, 0.0), (6, 1.0)):
        storms.stormfield.lam = lam
        storms.keyframe_insert("stormfield.lam", frame=frame)
    settings = storms.stormfield.bake
    settings.resolution, settings.voxel_size, settings.period = "256", 0.1, 4
    layer = (
        storms.data.uv_layers.new(name="Map") if "Map" not in storms.data.uv_layers else storms.data.uv_layers["Map"]
    )
    corners = np.random.default_rng(0).random(len(storms.data.loops) * 2).astype(np.float32)
    layer.uv.foreach_set("vector", corners)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def bake(*arguments):
    return main(["bake", *map(str, arguments)])


def folder_of(path, target):
    (found,) = (path.parent / "stormfield_cache" / "Ball").glob(f"{target}*")
    return found


def refused(capfd, *arguments):
    """The one line of a user fault."""
    capfd.readouterr()
    assert bake(*arguments) == 2
    captured = capfd.readouterr()
    lines = [line for line in captured.err.splitlines() if line.strip()]
    assert len(lines) == 1 and lines[0].startswith("stormfield: ")
    return lines[0]


def test_all_targets(file, capfd):
    capfd.readouterr()
    assert bake(file, "--targets", "usd,exr,vdb") == 0
    lines = capfd.readouterr().out.splitlines()
    assert [line.split("\t")[:2] for line in lines] == [["Ball", "usd"], ["Ball", "exr"], ["Ball", "vdb"]]
    assert all(Path(line.split("\t")[2]).is_dir() for line in lines)
    for target, ending in (("lambda", "usdc"), ("frames", "usdc"), ("exr", "exr"), ("vdb", "vdb")):
        folder = folder_of(file, target)
        assert (folder / "manifest.json").exists()
        files = [path.name for path in folder.rglob(f"*.{ending}")]
        assert files == ["field.usdc"] if ending == "usdc" else len(files) == 6


def test_morse_sets_over_lambda(file, storms):
    for element, kind in zip(storms.stormfield.elements, ("source", "sink"), strict=True):
        element.kind = kind
    storms.stormfield.morse.method = "geometry"
    bpy.ops.wm.save_mainfile()
    assert bake(file, "--targets", "morse") == 0
    ball = bpy.data.objects["Ball"]
    modifier = ball.modifiers["Stormfield Morse Sets"]
    assert Path(bpy.path.abspath(modifier.cache_file.filepath)).parent == folder_of(file, "morse")
    seen = []
    for frame in (1, 6):
        bpy.context.scene.frame_set(frame)
        mesh = ball.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        attributes = [mesh.attributes[name] for name in ("sf_morse", "sf_morse_kind")]
        assert all((a.data_type, a.domain, len(a.data)) == ("INT", "FACE", len(mesh.polygons)) for a in attributes)
        seen.append({tuple(face.value for face in faces) for faces in zip(*(a.data for a in attributes), strict=True)})
    # Elements that stay where they are: numbers and kinds (0 is source, 1 is sink) stay too.
    assert (-1, -1) in seen[0] and {kind for _, kind in seen[0]} >= {0, 1} and seen[0] == seen[1]


def test_two_machines_give_what_one_gives(file):
    assert bake(file, "--targets", "usd,exr") == 0
    expected = {target: contents(folder_of(file, target)) for target in ("frames", "exr")}
    for target in expected:
        for path in sorted(folder_of(file, target).rglob("*"), reverse=True):
            path.unlink() if path.is_file() else path.rmdir()
    assert bake(file, "--targets", "usd,exr", "--frames", "4-6") == 0
    assert not (folder_of(file, "exr") / "manifest.json").exists()
    assert bake(file, "--targets", "usd,exr", "--frames", "1-3") == 0
    assert {target: contents(folder_of(file, target)) for target in expected} == expected


def test_resume_writes_only_what_is_missing(file):
    assert bake(file, "--targets", "exr") == 0
    folder = folder_of(file, "exr")
    before = contents(folder)
    kept = (folder / "frames/frame_0001.exr").stat().st_mtime_ns
    (folder / "frames/frame_0002.exr").unlink()
    assert bake(file, "--targets", "exr", "--resume") == 0
    assert contents(folder) == before
    assert (folder / "frames/frame_0001.exr").stat().st_mtime_ns == kept


def test_a_saved_scene_shows_its_bakes(file, attribute):
    assert bake(file, "--save") == 0
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(file))
    obj = bpy.data.objects["Ball"]
    bpy.context.scene.frame_set(1)
    first = attribute(obj, "sf_advection"), attribute(obj, "sf_phase_a")
    bpy.context.scene.frame_set(4)
    assert attribute(obj, "sf_blend").shape == (len(obj.data.vertices),)
    assert all(
        not np.array_equal(a, attribute(obj, name))
        for a, name in zip(first, ("sf_advection", "sf_phase_a"), strict=True)
    )


def test_without_save_the_file_stays_as_it_was(file):
    before = file.read_bytes()
    assert bake(file, "--targets", "exr") == 0
    assert file.read_bytes() == before


def test_faults_are_one_line(file, capfd, tmp_path):
    assert "frame 7 is outside the bake, 1 to 6" in refused(capfd, file, "--frames", "5-7")
    (tmp_path / "broken.blend").write_bytes(b"not a blend")
    assert "cannot open" in refused(capfd, tmp_path / "broken.blend")
    obj = bpy.data.objects.get("Ball")
    bpy.ops.wm.open_mainfile(filepath=str(file))
    obj = bpy.data.objects["Ball"]
    obj.stormfield.bake.uv_layer = "Nope"
    bpy.ops.wm.save_mainfile()
    line = refused(capfd, file, "--targets", "exr")
    assert "'Nope'" in line and "'Map'" in line
    obj = bpy.data.objects["Ball"]
    while obj.data.uv_layers:
        obj.data.uv_layers.remove(obj.data.uv_layers[0])
    bpy.ops.wm.save_mainfile()
    assert "needs a UV layer" in refused(capfd, file, "--targets", "exr").replace("need a", "needs a")
    bpy.data.objects["Ball"].stormfield.enabled = False
    bpy.ops.wm.save_mainfile()
    assert "no object has a Stormfield field" in refused(capfd, file)


@pytest.fixture
def blender(tmp_path):
    """A program that takes Blender's own arguments."""
    program = tmp_path / "blender"
    script = Path(__file__).with_name("blender_command.py")
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{script}" "$@"\n')
    program.chmod(0o755)
    return program


def in_blender(blender, *arguments):
    return subprocess.run([str(word) for word in (blender, *arguments)], capture_output=True, text=True, check=False)


def test_blender_itself_has_the_command_line(file, blender, tmp_path):
    done = in_blender(blender, "-b", file, "--command", "stormfield", "bake", "--targets", "exr", "--frames", "1-3")
    assert done.returncode == 0, done.stderr
    part = contents(folder_of(file, "exr"))
    assert "plan.json" in part and "manifest.json" not in part
    early = in_blender(blender, "--command", "stormfield", "bake")
    assert early.returncode == 2 and "no scene is given" in early.stderr
    wrong = in_blender(blender, "-b", file, "--command", "stormfield", "bake", "--frames", "9-1")
    assert wrong.returncode == 2 and "ends before it starts" in wrong.stderr
    whole = in_blender(blender, "-b", file, "--command", "stormfield", "bake", "--targets", "exr", "--resume")
    assert whole.returncode == 0 and "manifest.json" in contents(folder_of(file, "exr"))


def test_a_join_waits_and_then_names_what_is_missing(file, capfd, monkeypatch):
    from stormfield.cli import bake as command

    monkeypatch.setattr(command, "APPEAR", 0.0)
    assert main(["bake", str(file), "--targets", "exr", "--join"]) == 1
    assert "the field is not solved" in capfd.readouterr().err
    assert bake(file, "--targets", "exr", "--frames", "1-4") == 0
    before = contents(folder_of(file, "exr"))
    assert main(["bake", str(file), "--targets", "exr", "--join"]) == 1
    assert "2 files are not written: exr/frames/frame_0005.exr, exr/frames/frame_0006.exr" in capfd.readouterr().err
    assert contents(folder_of(file, "exr")) == before
    assert bake(file, "--targets", "exr", "--frames", "5-6") == 0
    (folder_of(file, "exr") / "manifest.json").unlink(missing_ok=True)


def test_a_farm_runs_the_job_template(file, blender):
    openjd = Path(sys.executable).with_name("openjd")
    if not openjd.exists():
        pytest.skip("openjd-cli is not installed")
    template = Path(__file__).parents[2] / "pipelines" / "stormfield.openjd.yaml"
    parameters = {"SceneFile": file, "Frames": "1-6", "ChunkSize": 4, "Targets": "exr", "Blender": blender}
    pairs = [word for name, value in parameters.items() for word in ("-p", f"{name}={value}")]
    run = [openjd, "run", template, "--step", "Join", "--run-dependencies", *pairs]
    done = subprocess.run(list(map(str, run)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-3000:]
    assert (folder_of(file, "lambda") / "manifest.json").exists()
    farmed = contents(folder_of(file, "exr"))
    assert "manifest.json" in farmed
    assert bake(file, "--targets", "exr") == 0
    assert contents(folder_of(file, "exr")) == farmed


def test_eight_processes_at_once_give_what_one_gives(file, blender, scene):
    """Nobody has solved before: all begin with the same λ cache at once."""
    scene.frame_end = 16
    bpy.ops.wm.save_mainfile()
    words = (blender, "-b", file, "--command", "stormfield", "bake", "--targets", "usd,exr", "--resume")
    chunks = [f"{first}-{first + 1}" for first in range(1, 16, 2)]
    processes = [subprocess.Popen(list(map(str, (*words, "--frames", chunk)))) for chunk in chunks]
    assert [process.wait() for process in processes] == [0] * 8
    assert in_blender(*words[:-1], "--join").returncode == 0
    split = {target: contents(folder_of(file, target)) for target in ("lambda", "frames", "exr")}
    shutil.rmtree(file.parent / "stormfield_cache")
    assert bake(file, "--targets", "usd,exr") == 0
    assert {target: contents(folder_of(file, target)) for target in split} == split


MANAGER = """
const tasks = [];
const author = {
  Task: (name, type) => ({name, type, commands: [], needs: [],
    addCommand(command) { this.commands.push(command); }, addDependency(task) { this.needs.push(task.name); }}),
  Command: (name, parameters) => ({name, parameters}),
};
// As Flamenco describes it: chunks as "1-25", single frames as "7".
function frameChunker(frames, size) {
  const [first, last] = frames.split("-").map(Number), chunks = [];
  for (let a = first; a <= last; a += size) {
    const b = Math.min(a + size - 1, last);
    chunks.push(a === b ? `${a}` : `${a}-${b}`);
  }
  return chunks;
}
"""


def test_flamenco_compiles_the_job_into_commands_that_blender_takes(file, blender):
    """The Manager's own program is replaced by what its documentation promises to scripts; the commands are run."""
    quickjs = pytest.importorskip("quickjs")
    context = quickjs.Context()
    context.eval(MANAGER)
    context.eval((Path(__file__).parents[2] / "pipelines" / "stormfield.flamenco.js").read_text())
    settings = {"frames": "1-6", "chunk_size": 4, "targets": "exr", "blendfile": str(file)}
    context.eval(f"compileJob({{settings: {json.dumps(settings)}, addTask: (task) => tasks.push(task)}})")
    tasks = json.loads(context.eval("JSON.stringify(tasks)"))
    assert [task["name"] for task in tasks] == ["solve", "bake 1-4", "bake 5-6", "join"]
    assert [task["needs"] for task in tasks] == [[], ["solve"], ["solve"], ["bake 1-4", "bake 5-6"]]
    keys = json.loads(context.eval("JSON.stringify(JOB_TYPE.settings.map((setting) => setting.key))"))
    assert set(keys) == set(settings)
    for task in tasks:
        (command,) = task["commands"]
        parameters = command["parameters"]
        assert command["name"] == "blender-render" and parameters["exe"] == "{blender}"
        done = in_blender(blender, *parameters["argsBefore"], parameters["blendfile"], *parameters["args"])
        assert done.returncode == 0, done.stderr
    assert "manifest.json" in contents(folder_of(file, "exr"))
