# SPDX-License-Identifier: GPL-3.0-or-later
"""Set up Blender's window for a picture of the add-on; run inside the application and photograph the screen.

    STORMFIELD_SHOT=solved blender --factory-startup -P scripts/window_shot.py

Pictures: empty (a mesh without field), solved (strokes, fixed points, legend), arrows, solving (a solve that runs),
draw (a curve drawn on the
surface), monkey (several components and boundaries), panels (the lower half of the sidebar); and of the analysis:
analyzed (entities, separatrices and the list), graph (the graph editor beside the view, one entity selected),
paths (fixed points over λ, bifurcations as markers), morse (Morse sets as coloured faces and their graph),
edits (two entities, the faces that cancelling them would change, other partners), simplify (what would vanish),
engine and engine_morse (the same for the gas engine, when STORMFIELD_DATA names the folder with its data set).
The compiled core is taken from out/build-*, the add-on from this tree.
"""

import os
import sys
import traceback
from pathlib import Path

import bpy
from mathutils import Euler, Vector

ROOT = Path(__file__).resolve().parents[1]
PICTURE = os.environ.get("STORMFIELD_SHOT", "solved")
#: Panels that are open in a picture, where not all of the usual ones fit.
OPENED = {
    "panels": {"Field", "Bake", "Shading", "Look"},
    "analyzed": {"Field", "Analysis"},
    "graph": {"Field", "Analysis"},
    "paths": {"Field", "Analysis"},
    "morse": {"Field", "Analysis", "Flow Regions"},
    "edits": {"Analysis", "Edits"},
    "simplify": {"Analysis", "Edits"},
    "engine": {"Field", "Analysis"},
    "engine_morse": {"Field", "Analysis", "Flow Regions"},
}
ENGINE = Path(os.environ.get("STORMFIELD_DATA", "")) / "gasEngineV.t"
SUBDIVISIONS = int(os.environ.get("STORMFIELD_SUBDIVISIONS", "6"))


def load_addon():
    """The tree's addon/ folder under the name it has when installed."""
    packages = ROOT / "out" / "packages"
    packages.mkdir(parents=True, exist_ok=True)
    link = packages / "stormfield"
    if not link.is_symlink():
        link.symlink_to(Path("../../addon"), target_is_directory=True)
    sys.path[:0] = [str(packages), *(str(path) for path in ROOT.glob("out/build-*/native/bindings"))]
    import stormfield

    sys.path.append(str(ROOT / "out" / "igraph"))
    if PICTURE in OPENED:
        from stormfield.ui import analysis_panels, edit_panels, morse_panels, panels

        parts = (panels.CLASSES[1:], analysis_panels.CLASSES[:2], edit_panels.CLASSES, morse_panels.CLASSES)
        for panel in (panel for classes in parts for panel in classes):
            panel.bl_options = set() if panel.bl_label in OPENED[PICTURE] else {"DEFAULT_CLOSED"}
    if (ROOT / "out" / "assets" / "stormfield.blend").is_file():  # scripts/build_assets.py out/assets
        from stormfield import assets

        assets.FOLDER = ROOT / "out" / "assets"
    stormfield.register()
    if not bpy.app.build_options.usd and "STORMFIELD_PLAIN" not in os.environ:
        do_without_usd()


def do_without_usd():
    """Linux distributions build Blender without USD. The cache is then written by usd-core (out/usd-core), and this
    script, instead of Blender's Mesh Sequence Cache, puts the attributes of the current λ onto the mesh."""
    sys.path.append(str(ROOT / "out" / "usd-core"))
    from stormfield.cache.field_cache import open_cache
    from stormfield.operators import requirements
    from stormfield.scene.read import attached
    from stormfield.scene.write import attach

    requirements._has_usd = lambda: True
    requirements.problem.cache_clear()  # register() has asked
    caches = {}

    def show(scene, *_):
        for obj in scene.objects:
            if obj.name in caches:
                for name, values in caches[obj.name].at(obj.stormfield.lam).items():
                    kind = "FLOAT_VECTOR" if values.ndim == 2 else "FLOAT"
                    attribute = obj.data.attributes.get(name) or obj.data.attributes.new(name, kind, "POINT")
                    attribute.data.foreach_set("vector" if values.ndim == 2 else "value", values.ravel())
                obj.data.update_tag()

    def remember(obj, folder):
        caches[obj.name] = open_cache(folder)
        show(bpy.context.scene)

    attach.attach_lambda = remember
    known = attached.attached_folder
    for module in list(sys.modules.values()):
        if getattr(module, "attached_folder", None) is known:
            module.attached_folder = lambda obj, _name: caches[obj.name].folder if obj.name in caches else None
    bpy.app.handlers.frame_change_post.append(show)


def view_area():
    return next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")


def show_only_our_tab():
    """Scripts cannot choose a tab of the sidebar; without the others ours is in front."""
    for panel in bpy.types.Panel.__subclasses__():
        ours = getattr(panel, "bl_category", "") == "Stormfield"
        if (panel.bl_space_type, panel.bl_region_type) == ("VIEW_3D", "UI") and not ours and panel.is_registered:
            bpy.utils.unregister_class(panel)


def set_up_view(target=None):
    """Sidebar on the Stormfield tab, a plain view."""
    area = view_area()
    space = area.spaces.active
    space.show_region_ui = True
    space.show_region_toolbar = True
    space.overlay.show_floor = False
    space.overlay.show_axis_x = space.overlay.show_axis_y = False
    space.overlay.show_relationship_lines = False
    space.shading.color_type = "SINGLE"
    space.shading.single_color = (0.32, 0.34, 0.37)
    show_only_our_tab()
    view = space.region_3d
    view.view_perspective = "PERSP"
    if target is not None:
        bpy.context.view_layer.update()
        view.view_rotation = bpy.context.scene.camera.matrix_world.to_quaternion()
        view.view_distance = 3.3
        view.view_location = view.view_rotation @ Vector((0.3, 0.0, 0.0))
    area.tag_redraw()


def picture():
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    if PICTURE == "empty":
        bpy.ops.mesh.primitive_monkey_add()
        set_up_view()
        return
    if PICTURE in {"draw", "monkey"}:
        bpy.ops.mesh.primitive_monkey_add()
        bpy.ops.object.shade_smooth()
        bpy.ops.object.modifier_add(type="SUBSURF")
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        bpy.ops.stormfield.add_field()
        set_up_view()
        area = view_area()
        area.spaces.active.region_3d.view_rotation = Euler((1.35, 0.0, 0.35)).to_quaternion()
        area.spaces.active.region_3d.view_distance = 5.0
        with bpy.context.temp_override(area=area, region=area.regions[-1]):
            if PICTURE == "draw":
                bpy.ops.stormfield.draw_element("EXEC_DEFAULT", type="streamline")
                return
            for place, kind in (
                ((0, -1, 0.5), "vortex_ccw"),
                ((0.8, -0.6, 0.2), "spiral_in_cw"),
                ((0, -1, -1), "source"),
            ):
                bpy.context.scene.cursor.location = place
                bpy.ops.stormfield.place_element("EXEC_DEFAULT", kind=kind)
            bpy.context.scene.cursor.location = (0, 0, 0)
            bpy.context.object.stormfield.solve.samples = 10
            print("solve", bpy.ops.stormfield.solve("EXEC_DEFAULT"))
        return
    if PICTURE in {"analyzed", "graph", "morse"}:
        analyze(weather(), distance=3.3)
        return
    if PICTURE in {"edits", "simplify"}:
        show_edits(weather())
        return
    if PICTURE.startswith("engine"):
        analyze(engine(), distance=2.3, turned=(0.75, 0.0, 0.35))
        return
    from stormfield.presets import storm_merge

    planet = storm_merge.build(bpy.context, subdivisions=SUBDIVISIONS, frames=96)
    planet.select_set(True)
    bpy.context.scene.camera.hide_set(True)
    for obj in bpy.context.scene.objects:
        if obj.type == "LIGHT":
            obj.hide_set(True)
    planet.stormfield.look.style = "ARROWS" if PICTURE == "arrows" else "STROKES"
    planet.stormfield.active_element = planet.stormfield.elements.find("Storm West")
    set_up_view(planet)
    area = view_area()
    with bpy.context.temp_override(area=area, region=area.regions[-1]):
        if PICTURE == "solving":
            planet.stormfield.solve.samples = 400
            bpy.ops.stormfield.solve("INVOKE_DEFAULT")
        else:
            bake = planet.stormfield.bake
            bake.use_exr = bake.use_vdb = PICTURE == "panels"
            print("solve", bpy.ops.stormfield.solve("EXEC_DEFAULT"))
    bpy.context.scene.frame_set(int(os.environ.get("STORMFIELD_FRAME", "30")))
    if PICTURE == "paths":
        planet.stormfield.look.opacity = 0.4
        planet.stormfield.look.show_elements = False  # their names would lie on those of the paths
        with bpy.context.temp_override(area=area, region=area.regions[-1]):
            print("over λ", bpy.ops.stormfield.analyze_lambda("EXEC_DEFAULT"))
        history = planet.stormfield.analysis.history
        merged = [i for i, item in enumerate(history.items) if item.kind == "annihilation"]
        history.active = max(merged, key=lambda i: history.items[i].life, default=-1)
        for marker in bpy.context.scene.timeline_markers:
            print("marker", marker.frame, marker.name)
        taller_timeline()


def taller_timeline():
    """Room for the names of markers: a timeline below the view instead of the small one."""
    window, area = bpy.context.window, view_area()
    before = set(window.screen.areas)
    with view_override():
        bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.16)
    made = next(iter(set(window.screen.areas) - before))
    made.ui_type = "TIMELINE" if made.y < area.y else made.ui_type
    space = made.spaces.active
    space.show_markers = True
    small = next(a for a in before if a.ui_type == "TIMELINE")
    with bpy.context.temp_override(window=window, area=small):
        bpy.ops.screen.area_close()
    region = next(region for region in made.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=made, region=region):
        bpy.ops.action.view_all()


#: Fixed points of a small world with weather: direction from its centre, and kind.
WEATHER = (
    ((0.2, -1.0, 0.55), "spiral_in_ccw"),
    ((-0.75, -0.8, 0.1), "spiral_out_cw"),
    ((0.8, -0.7, -0.1), "sink"),
    ((0.1, -0.95, -0.6), "source"),
    ((-0.5, -0.4, 0.9), "source"),
    ((0.9, 0.2, 0.7), "spiral_out_ccw"),
    ((-0.9, 0.3, -0.5), "sink"),
    ((0.3, 0.9, 0.4), "spiral_in_cw"),
    ((-0.3, 0.8, -0.6), "source"),
    ((0.6, 0.3, -0.9), "sink"),
)


def weather():
    """A ball with sources, sinks and spirals, solved."""
    coarser = PICTURE == "morse"  # so that the sets can be seen
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=SUBDIVISIONS - coarser, radius=1.0)
    bpy.ops.object.shade_smooth()
    ball = bpy.context.object
    ball.name = "Small World"
    bpy.ops.stormfield.add_field()
    for place, kind in WEATHER:
        bpy.context.scene.cursor.location = Vector(place).normalized()
        bpy.ops.stormfield.place_element("EXEC_DEFAULT", kind=kind)
    bpy.context.scene.cursor.location = (0, 0, 0)
    for element in ball.stormfield.elements:
        element.source.hide_set(True)
    ball.stormfield.solve.samples = 3
    with view_override():
        print("solve", bpy.ops.stormfield.solve("EXEC_DEFAULT"))
    return ball


def engine():
    """The gas engine with its flow as attributes, as large as a unit ball."""
    from stormfield.readers import read_field

    data = read_field(ENGINE)
    mesh = bpy.data.meshes.new("Gas Engine")
    size = abs(data.mesh.vertices).max()
    mesh.from_pydata((data.mesh.vertices / size).tolist(), [], data.mesh.triangles.tolist())
    made = bpy.data.objects.new("Gas Engine", mesh)
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.objects.active = made
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.stormfield.add_field()
    attribute = mesh.attributes.new("sf_advection", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", (data.vectors[0] / size).astype("float32").ravel())
    return made


def view_override():
    area = view_area()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(area=area, region=region)


def analyze(ball, distance, turned=(1.35, 0.0, 0.0)):
    """Analyze, and show what the picture is about."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.rotation_euler = turned
    camera.hide_set(True)
    set_up_view(ball)
    look, analysis = ball.stormfield.look, ball.stormfield.analysis
    look.opacity = 0.45
    area = view_area()
    area.spaces.active.region_3d.view_distance = distance
    with view_override():
        print("analyze", bpy.ops.stormfield.analyze("EXEC_DEFAULT"))
        if "morse" in PICTURE:
            if PICTURE == "morse":
                ball.stormfield.morse.method, ball.stormfield.morse.eps = "geometry", 12.0
            print("morse", bpy.ops.stormfield.morse_sets("EXEC_DEFAULT"))
            analysis.show_separatrices = False
        if PICTURE not in {"analyzed", "edits", "simplify"}:
            print("graph", bpy.ops.stormfield.show_graph("EXEC_DEFAULT"))
            area.spaces.active.region_3d.view_distance *= 1.25
    analysis.show_names = PICTURE == "graph"
    ball.select_set(False)
    chosen = analysis.list(analysis.shown)
    towards = area.spaces.active.region_3d.view_rotation @ Vector((0.0, 0.2, 1.0))
    kind = "sink" if PICTURE == "morse" else "saddle"
    ones = [i for i, item in enumerate(chosen.items) if item.kind == kind]
    if ones and PICTURE not in {"analyzed", "edits", "simplify"}:
        chosen.active = max(ones, key=lambda i: towards.dot(Vector(chosen.items[i].position)))


def show_edits(ball):
    """A source and the saddle beside it, or what Simplify would take away."""
    from stormfield.scene.write import selection

    analyze(ball, distance=3.3)
    analysis = ball.stormfield.analysis
    ball.select_set(True)
    if PICTURE == "simplify":
        analysis.keep, analysis.preview_simplify = 10, True
        return
    towards = view_area().spaces.active.region_3d.view_rotation @ Vector((-0.5, -0.2, 1.0))
    facing = [towards.dot(Vector(item.position)) for item in analysis.ecg.items]
    places = range(len(facing))
    source = max((i for i in places if analysis.ecg.items[i].kind == "source"), key=facing.__getitem__)
    own = Vector(analysis.ecg.items[source].position)
    saddles = (i for i in places if analysis.ecg.items[i].kind == "saddle" and facing[i] > 0.5)
    saddle = min(saddles, key=lambda i: (Vector(analysis.ecg.items[i].position) - own).length)
    selection.select(ball, "ecg", saddle)
    selection.extend(ball, "ecg", source)


def guarded():
    try:
        picture()
    except Exception:
        traceback.print_exc()


if __name__ == "__main__":  # docs_pictures.py takes parts of this
    load_addon()
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(guarded, first_interval=1.5)
