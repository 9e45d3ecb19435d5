"""Set up Blender's window for a picture of the add-on; run inside the application and photograph the screen.

    STORMFIELD_SHOT=solved blender --factory-startup -P scripts/window_shot.py

Pictures: empty (a mesh without field), solved (strokes, fixed points, legend), arrows, solving (a solve that runs),
draw (a curve drawn on the
surface), monkey (several components and boundaries), panels (the lower half of the sidebar).
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

    if PICTURE == "panels":
        from stormfield.ui import panels

        for panel in panels.CLASSES[1:]:
            opened = panel.bl_label in {"Field", "Bake", "Shading", "Look"}
            panel.bl_options = set() if opened else {"DEFAULT_CLOSED"}
    stormfield.register()
    if not bpy.app.build_options.usd:
        do_without_usd()


def do_without_usd():
    """Linux distributions build Blender without USD. The cache is then written by usd-core (out/usd-core), and this
    script, instead of Blender's Mesh Sequence Cache, puts the attributes of the current λ onto the mesh."""
    sys.path.append(str(ROOT / "out" / "usd-core"))
    from stormfield.bake.cache import open_cache
    from stormfield.convert import attach
    from stormfield.operators import requirements

    requirements._has_usd = lambda: True
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


def guarded():
    try:
        picture()
    except Exception:
        traceback.print_exc()


load_addon()
bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(guarded, first_interval=1.5)
