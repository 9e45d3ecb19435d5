# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on by hand: operators change what they say, tell why they are grey, and can be undone."""

from pathlib import Path

import bpy
import numpy as np
import pytest


def test_register_and_unregister_twice_leave_nothing(addon):
    before = {name: len(getattr(bpy.app.handlers, name)) for name in ("save_pre", "load_pre", "depsgraph_update_post")}
    addon.unregister()
    assert not hasattr(bpy.types.Object, "stormfield")
    assert not hasattr(bpy.types, "STORMFIELD_PT_field")
    addon.register()
    addon.unregister()
    addon.register()
    assert before == {name: len(getattr(bpy.app.handlers, name)) for name in before}


def test_every_operator_and_property_says_what_it_is(addon):
    from stormfield import operators, properties

    for cls in operators.CLASSES:
        assert cls.__doc__, cls
    for cls in properties.CLASSES:
        for prop in cls.bl_rna.properties:
            if prop.identifier not in {"rna_type", "elements", "solve", "bake", "look", "analysis", "morse", "name"}:
                assert prop.description, f"{cls.__name__}.{prop.identifier}"


def test_add_field_keys_lambda_over_the_scene(ball):
    from stormfield import compat

    curve = compat.find_fcurve(ball, "stormfield.lam")
    assert [tuple(key.co) for key in curve.keyframe_points] == [(1.0, 0.0), (50.0, 1.0)]
    bpy.context.scene.frame_set(50)
    assert ball.stormfield.lam == 1.0
    assert not bpy.ops.stormfield.add_field.poll()


def test_operators_are_grey_without_a_field():
    bpy.ops.mesh.primitive_cube_add()
    assert bpy.ops.stormfield.add_field.poll()
    for name in ("remove_field", "key_lambda", "add_elements", "draw_element", "solve", "bake", "apply_material"):
        assert not getattr(bpy.ops.stormfield, name).poll(), name
    with pytest.raises(RuntimeError, match="add one in the Field panel"):
        bpy.ops.stormfield.solve()


def test_a_mesh_without_faces_is_refused():
    mesh = bpy.data.meshes.new("Points")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    obj = bpy.data.objects.new("Points", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="has no faces"):
        bpy.ops.stormfield.add_field()


def test_selected_curves_and_empties_become_elements(ball, add_curve):
    curve = add_curve([(1, 0, 0), (0, 1, 0)], name="Strömung")
    empty = bpy.data.objects.new("Auge", None)
    bpy.context.collection.objects.link(empty)
    empty.keyframe_insert("location", frame=1)
    for obj in (curve, empty):
        obj.select_set(True)
    bpy.ops.stormfield.add_elements(type="pathline")
    elements = {element.name: element for element in ball.stormfield.elements}
    assert elements["Strömung"].type == "pathline" and not elements["Strömung"].from_animation
    assert elements["Auge"].type == "singular" and elements["Auge"].from_animation
    assert not bpy.ops.stormfield.add_elements.poll()


def test_elements_move_change_and_go(ball):
    for kind in ("source", "sink", "saddle"):
        bpy.ops.stormfield.place_element(kind=kind)
    field = ball.stormfield
    assert [element.name for element in field.elements] == ["Source", "Sink", "Saddle"]
    bpy.ops.stormfield.move_element(direction="UP")
    assert [element.name for element in field.elements] == ["Source", "Saddle", "Sink"]
    bpy.ops.stormfield.element_preset(preset="CYCLONE")
    assert field.active().kind == "spiral_in_ccw"
    bpy.ops.stormfield.remove_element()
    assert [element.name for element in field.elements] == ["Source", "Sink"]


def test_a_placed_element_lies_on_the_surface_and_follows_the_mesh(ball):
    ball.location = (4, 0, 0)
    bpy.context.view_layer.update()
    bpy.context.scene.cursor.location = (4, 0, 9)
    bpy.ops.stormfield.place_element(kind="vortex_cw")
    bpy.context.view_layer.update()
    place = ball.stormfield.elements[0].source.matrix_world.translation
    assert np.allclose(place, (4, 0, 1), atol=0.02)


def test_drawing_uses_blenders_own_tool_on_the_surface(ball):
    bpy.ops.stormfield.draw_element(type="singular")
    curve = bpy.context.object
    assert bpy.context.mode == "EDIT_CURVE" and curve.parent == ball
    paint = bpy.context.scene.tool_settings.curve_paint_settings
    assert paint.depth_mode == "SURFACE" and paint.use_project_only_selected and ball.select_get()
    assert ball.stormfield.elements[0].source == curve
    bpy.ops.stormfield.finish_drawing()
    assert bpy.context.mode == "OBJECT" and bpy.context.object == ball


def test_a_curve_that_is_drawn_shows_its_field(ball, add_curve):
    from stormfield.scene.read.active_field import active_field

    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.stormfield.add_field()
    curve = add_curve([(1, 0, 0), (0, 1, 0)])
    bpy.context.view_layer.objects.active = curve
    assert active_field(bpy.context) is None  # two fields, and the curve belongs to neither
    element = ball.stormfield.elements.add()
    element.source = curve
    assert active_field(bpy.context) == ball


def test_remove_field_leaves_no_trace(storms, native):
    from stormfield import compat

    bpy.ops.stormfield.solve()
    bpy.ops.stormfield.remove_field()
    assert not storms.stormfield.enabled and not storms.stormfield.elements
    assert not bpy.data.cache_files
    assert not storms.modifiers and compat.find_fcurve(storms, "stormfield.lam") is None
    assert "East" in bpy.data.objects


def test_solve_brings_the_field_onto_the_own_mesh(storms, native, attribute):
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    storms.modifiers.new("Subdivision", "SUBSURF")
    assert [modifier.name for modifier in storms.modifiers][:1] == ["Stormfield λ"]
    storms.modifiers["Subdivision"].show_viewport = False
    bpy.context.scene.frame_set(1)
    first = attribute(storms, "sf_advection")
    normals = np.array([vertex.normal for vertex in storms.data.vertices])
    speed = np.linalg.norm(first, axis=1)
    assert speed.max() > 0.05 and np.isfinite(first).all()
    assert np.abs((first * normals).sum(axis=1)).max() < 0.1 * speed.max()
    assert attribute(storms, "sf_speed") == pytest.approx(speed, abs=1e-5)
    turning = np.cross(np.array([vertex.co for vertex in storms.data.vertices]), first)  # both turn left from outside
    near = [np.linalg.norm(np.array(v.co) - (1, 0, 0)) < 0.3 for v in storms.data.vertices]
    assert (turning[near] @ (1, 0, 0) > -0.01).all()


def test_the_field_follows_lambda_without_a_new_solve(storms, native, attribute):
    empty = bpy.data.objects["West"]
    for frame, y in ((1, -0.5), (50, 0.5)):
        empty.location = (-1, y, 0)
        empty.keyframe_insert("location", frame=frame)
    storms.stormfield.elements["West"].from_animation = True
    bpy.ops.stormfield.solve()
    scene = bpy.context.scene
    fields = []
    for frame in (1, 25, 50):
        scene.frame_set(frame)
        fields.append(attribute(storms, "sf_advection"))
    assert np.abs(fields[0] - fields[2]).max() > 0.05 and np.abs(fields[0] - fields[1]).max() > 0.01
    from stormfield import compat

    for key in compat.find_fcurve(storms, "stormfield.lam").keyframe_points:
        key.co.y = 1.0 - key.co.y  # the film runs backwards: no new solve
    scene.frame_set(50)
    assert np.allclose(attribute(storms, "sf_advection"), fields[0], atol=1e-6)


def test_the_same_design_finds_its_cache_again(storms, native):
    from stormfield.scene.read.attached import LAMBDA, attached_folder

    bpy.ops.stormfield.solve()
    folder = attached_folder(storms, LAMBDA)
    stamp = (folder / "manifest.json").stat().st_mtime_ns
    bpy.ops.stormfield.solve()
    assert attached_folder(storms, LAMBDA) == folder
    assert (folder / "manifest.json").stat().st_mtime_ns == stamp
    storms.stormfield.elements[0].radius = 0.5
    bpy.ops.stormfield.solve()
    assert attached_folder(storms, LAMBDA) != folder and (folder / "manifest.json").exists()
    assert len(storms.modifiers) == 1


def test_undo_brings_the_earlier_field_back(storms, native, attribute):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.stormfield.solve()
    bpy.ops.ed.undo_push(message="first solve")
    before = attribute(storms, "sf_advection")
    storms.stormfield.elements[0].kind = "sink"
    bpy.ops.stormfield.solve()
    bpy.ops.ed.undo_push(message="second solve")
    assert not np.allclose(attribute(bpy.data.objects["Ball"], "sf_advection"), before)
    bpy.ops.ed.undo()
    ball = bpy.data.objects["Ball"]
    assert ball.stormfield.elements[0].kind == "vortex_ccw"
    assert np.allclose(attribute(ball, "sf_advection"), before)
    bpy.ops.ed.undo()
    assert not bpy.data.objects["Ball"].modifiers


def test_a_fault_of_the_design_is_told_and_changes_nothing(storms, native):
    storms.stormfield.elements[0].source.location = (9, 9, 9)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="West"):
        bpy.ops.stormfield.solve()
    assert not storms.modifiers
    from stormfield.session import running

    assert running.current() is None


def test_a_temporary_cache_moves_beside_the_file(storms, native, attribute, tmp_path):
    bpy.ops.stormfield.solve()
    temporary = Path(storms.modifiers[0].cache_file.filepath).parent
    assert tmp_path / "temporary" in temporary.parents
    before = attribute(storms, "sf_advection")
    blend = tmp_path / "Zwei Stürme.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert storms.modifiers[0].cache_file.filepath.startswith("//stormfield_cache/Ball/lambda-")
    assert temporary.exists()  # undo goes back to it
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert np.array_equal(attribute(bpy.data.objects["Ball"], "sf_advection"), before)


def test_saving_under_another_name_keeps_the_field(storms, native, attribute, tmp_path):
    bpy.ops.stormfield.solve()
    before = attribute(storms, "sf_advection")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "one.blend"))
    (tmp_path / "sub").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "sub" / "two.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "sub" / "two.blend"))
    assert np.array_equal(attribute(bpy.data.objects["Ball"], "sf_advection"), before)


def test_geometry_nodes_and_other_modifiers_read_the_same_data(storms, native):
    bpy.ops.stormfield.solve()
    group = bpy.data.node_groups.new("Reader", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    read, shift = group.nodes.new("GeometryNodeInputNamedAttribute"), group.nodes.new("GeometryNodeSetPosition")
    read.data_type = "FLOAT_VECTOR"
    read.inputs["Name"].default_value = "sf_advection"
    group.links.new(start.outputs[0], shift.inputs["Geometry"])
    group.links.new(read.outputs[0], shift.inputs["Offset"])
    group.links.new(shift.outputs[0], end.inputs[0])
    storms.modifiers.new("Reader", "NODES").node_group = group
    evaluated = storms.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    moved = max((a.co - b.co).length for a, b in zip(evaluated.vertices, storms.data.vertices, strict=True))
    assert moved > 0.05


def test_bake_writes_frames_and_attaches_them(storms, native, attribute):
    pytest.importorskip("stormfield.bake.targets.frames")
    bpy.ops.stormfield.solve()
    settings = storms.stormfield.bake
    settings.use_scene_frames, settings.frame_start, settings.frame_end, settings.period = False, 1, 4, 4
    assert bpy.ops.stormfield.bake() == {"FINISHED"}
    assert [modifier.name for modifier in storms.modifiers] == ["Stormfield λ", "Stormfield Flow"]
    bpy.context.scene.frame_set(3)
    assert attribute(storms, "sf_phase_a").shape == (len(storms.data.vertices), 3)
    blend = attribute(storms, "sf_blend")
    assert blend.min() >= 0.0 and blend.max() <= 1.0
    assert attribute(storms, "sf_advection").any()


def test_bake_writes_flow_maps_and_volumes(storms, native, tmp_path):
    bpy.ops.stormfield.solve()
    settings = storms.stormfield.bake
    settings.use_frames, settings.use_exr, settings.use_vdb, settings.resolution = False, True, True, "256"
    settings.use_scene_frames, settings.frame_start, settings.frame_end = False, 2, 3
    settings.folder = str(tmp_path)
    assert bpy.ops.stormfield.bake() == {"FINISHED"}
    names = sorted(path.name for path in (tmp_path / "Ball").rglob("frame_*"))
    assert names == ["frame_0002.exr", "frame_0002.vdb", "frame_0003.exr", "frame_0003.vdb"]


def test_bake_is_grey_until_solved_and_says_why(storms, native):
    with pytest.raises(RuntimeError, match="Solve first"):
        bpy.ops.stormfield.bake()
    bpy.ops.stormfield.solve()
    storms.stormfield.bake.use_exr = True
    while storms.data.uv_layers:
        storms.data.uv_layers.remove(storms.data.uv_layers[0])
    with pytest.raises(RuntimeError, match="need a UV layer"):
        bpy.ops.stormfield.bake()


def test_without_the_core_solve_says_why(storms, monkeypatch):
    from stormfield.operators import requirements

    monkeypatch.setattr(requirements, "problem", lambda: "The compiled core is missing: install the wheel")
    with pytest.raises(RuntimeError, match="install the wheel"):
        bpy.ops.stormfield.solve()


def test_materials_can_be_given(ball):
    from stormfield import shading

    for name in shading.MATERIALS:
        assert bpy.ops.stormfield.apply_material(material=name) == {"FINISHED"}
        assert ball.active_material is not None
    assert len(ball.data.materials) == 1


def test_presets_of_the_addon_set_the_settings(ball):
    from stormfield.operators.presets import SUBFOLDER, VALUES

    folders = [folder for folder in bpy.utils.preset_paths(SUBFOLDER) if "stormfield" in folder]
    names = sorted(path.stem for folder in folders for path in Path(folder).glob("*.py"))
    assert {"Calm", "Draft", "Final", "Nervous"} <= set(names)
    path = next(Path(folder) / "Calm.py" for folder in folders if (Path(folder) / "Calm.py").exists())
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="STORMFIELD_PT_presets")
    assert ball.stormfield.solve.lambda_weight == 40.0 and ball.stormfield.bake.period == 96
    for value in VALUES:
        ball.path_resolve(f"stormfield.{value}")


def test_what_was_tried_is_deleted_but_never_the_one_that_is_shown(storms, native):
    from stormfield.scene.read.attached import LAMBDA, attached_folder
    from stormfield.session import made_caches

    shown = []
    for number in range(made_caches.KEPT + 3):
        storms.stormfield.elements[0].radius = 0.3 + 0.02 * number
        bpy.ops.stormfield.solve()
        shown.append(attached_folder(storms, LAMBDA))
    assert shown[-1].is_dir()
    kept = {path for path in shown[-1].parent.iterdir() if path.name.startswith("lambda-")}
    assert kept == set(shown[-1 - made_caches.KEPT :])


@pytest.fixture
def stroke():
    """Draws a stroke over the front of the ball, as the Draw tool does, on the curve that is being edited."""

    def draw():
        base = {"name": "", "mouse": (0, 0), "mouse_event": (0, 0), "pressure": 1, "size": 0, "time": 0, "x_tilt": 0}
        places = [(x, -((1 - x * x) ** 0.5), 0.0) for x in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)]
        points = [base | {"y_tilt": 0, "is_start": x == 0, "location": (x, y, z)} for x, y, z in places]
        assert bpy.ops.curve.draw(stroke=points) == {"FINISHED"}

    return draw


def test_solve_takes_what_was_just_drawn_and_is_still_edited(ball, native, stroke):
    """The curve in plain sight counts, also before Tab or Finish Drawing."""
    bpy.ops.stormfield.draw_element(type="streamline")
    stroke()
    assert bpy.context.mode == "EDIT_CURVE"
    ball.stormfield.solve.samples = 2
    assert bpy.ops.stormfield.solve() == {"FINISHED"}
    assert bpy.context.mode == "EDIT_CURVE"  # the artist may draw on


def test_solve_takes_every_stroke_of_an_edited_curve(ball, native, stroke):
    from stormfield.scene.read.design import read_design

    bpy.ops.stormfield.draw_element(type="streamline")
    for strokes in (1, 2):
        stroke()
        _, design = read_design(bpy.context, ball)
        assert len(design.elements) == strokes


def test_each_preset_is_drawn_with_its_meaning_and_has_a_picture(ball):
    from stormfield.operators.elements import PRESETS
    from stormfield.ui import pictures

    for key, (label, _text, settings) in PRESETS.items():
        assert bpy.ops.stormfield.draw_element(preset=key) == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")
        element = ball.stormfield.elements[-1]
        assert element.name.startswith(label) and element.source.type == "CURVE"
        assert all(
            getattr(element, name) == pytest.approx(value) for name, value in settings.items() if name == "strength"
        )
        assert all(getattr(element, name) == value for name, value in settings.items() if name != "strength")
        assert (pictures.FOLDER / f"{key.lower()}.png").is_file()
    assert {path.stem for path in pictures.FOLDER.glob("*.png")} == {key.lower() for key in PRESETS}
