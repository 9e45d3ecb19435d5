# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow Curves: streamlines, pathlines, streaklines and timelines through seeds, which follow the frames."""

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, IntProperty

from ..analysis.flow_curves import BY_FRAME, Settings, flow_curve_steps
from ..analysis.seeds import even_seeds, vertex_seeds
from ..model.errors import InputError
from ..scene.nodes import growth
from ..scene.read.attached import LAMBDA, attached_folder
from ..scene.read.current_field import cache_of, read_current, surface_in
from ..scene.read.lambda_seen import lambda_at_frames
from ..scene.read.mesh import read_mesh
from ..scene.write.curve_objects import make_curves
from ..shading.flow_lines import flow_lines
from .analyze import AnalysisOperator

KINDS = (
    ("STREAMLINE", "Streamlines", "Paths in the field as it stands at the current λ, growing from their seeds"),
    ("PATHLINE", "Pathlines", "Paths of particles in the field as it changes, growing over the frames"),
    ("STREAKLINE", "Streaklines", "Where the particles released at a seed one after the other are, as smoke shows"),
    ("TIMELINE", "Timelines", "Where the particles of a ring around each seed have gone, as drops of dye show"),
)
SEEDS = (
    ("EVEN", "Spread Evenly", "Random points, far from each other"),
    ("SELECTED", "Selected Vertices", "The vertices that are selected in Edit Mode"),
)
#: Role of the Curves object under the field's mesh, by kind.
ROLES = {kind: name for kind, name, _description in KINDS}


class STORMFIELD_OT_pathlines(AnalysisOperator, bpy.types.Operator):
    """Draw paths of particles as curves that follow the frames, in renders as well. Run again to update"""

    bl_idname = "stormfield.pathlines"
    bl_label = "Flow Curves"
    bl_options = {"REGISTER", "UNDO"}
    job_title = "Following particles on"

    kind: EnumProperty(name="Kind", description="What the curves show", items=KINDS, default="PATHLINE")
    seeds: EnumProperty(name="Start From", description="Where the curves begin", items=SEEDS, default="EVEN")
    count: IntProperty(
        name="Points", description="Number of points to start from", default=100, min=1, soft_max=2000, max=100000
    )
    seed: IntProperty(name="Seed", description="Another number spreads the points otherwise", default=0, min=0)
    speed: FloatProperty(
        name="Speed", description="Factor on the field; below zero, particles go backwards", default=1.0, soft_max=10.0
    )
    tail: FloatProperty(
        name="Tail",
        description="How long streamlines and pathlines stay behind the particle; 0 keeps them (seconds)",
        default=0.0,
        min=0.0,
        unit="TIME_ABSOLUTE",
    )
    spacing: FloatProperty(
        name="Spacing",
        description="Largest distance between particles of a streakline or timeline over the object's size (fraction)",
        default=0.01,
        min=0.001,
        max=0.5,
        precision=3,
    )
    ring: FloatProperty(
        name="Ring",
        description="Radius of the rings that timelines begin as, over the object's size (fraction)",
        default=0.05,
        min=0.001,
        max=0.5,
        precision=3,
    )
    radius: FloatProperty(
        name="Radius",
        description="Radius of the curves over the object's size (fraction)",
        default=0.003,
        min=0.0001,
        max=0.1,
        precision=4,
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "kind")
        layout.prop(self, "seeds")
        if self.seeds == "EVEN":
            layout.prop(self, "count")
            layout.prop(self, "seed")
        layout.prop(self, "speed")
        if self.kind in BY_FRAME:
            layout.prop(self, "spacing")
            if self.kind == "TIMELINE":
                layout.prop(self, "ring")
        else:
            layout.prop(self, "tail")
        layout.prop(self, "radius")

    def start(self, context, obj):
        scene = context.scene
        frames = list(range(scene.frame_start, scene.frame_end + 1))
        if len(frames) < 2:
            raise InputError("the scene has a single frame; particles need time to move")
        lam = obj.evaluated_get(context.evaluated_depsgraph_get()).stormfield.lam
        settings = Settings(
            kind=self.kind,
            frames=frames,
            lambdas=lambda_at_frames(context, obj, frames),
            frames_per_second=scene.render.fps / scene.render.fps_base,
            speed=self.speed,
            lam=lam,
            spacing=self.spacing,
            ring=self.ring,
            radius=self.radius,
        )
        self._frames = frames[0], frames[-1]
        if attached_folder(obj, LAMBDA) is not None:
            mesh, attribute = read_mesh(obj), obj.stormfield.look.shown_field
            cache = cache_of(obj, mesh)
            surface = surface_in(obj, mesh)
            lambdas = cache.lambdas
            read_sample = lambda j: surface.to_surface(cache.sample(j)[attribute])  # noqa: E731
        else:
            field = read_current(context, obj)
            surface, lambdas = field.surface, np.zeros(1)
            read_sample = lambda _j: field.values  # noqa: E731
        if self.seeds == "SELECTED":
            chosen = np.empty(len(obj.data.vertices), bool)
            obj.data.vertices.foreach_get("select", chosen)
            if not chosen.any():
                raise InputError(f"no vertex of '{obj.name}' is selected; select some in Edit Mode")
            numbers = surface.number[chosen]
            seeds_of = lambda mesh: vertex_seeds(mesh, np.unique(numbers[numbers >= 0]))  # noqa: E731
        else:
            count, seed = self.count, self.seed
            seeds_of = lambda mesh: even_seeds(mesh, count, seed)  # noqa: E731
        return flow_curve_steps(surface.mesh, lambdas, read_sample, seeds_of, settings)

    def finish(self, _context, obj, drawing):
        curves = make_curves(
            ROLES[self.kind],
            drawing.curves,
            drawing.attributes,
            drawing.radius,
            curve_attributes=drawing.curve_attributes,
            parent=obj,
            material=flow_lines(),
        )
        if self.kind in BY_FRAME:
            growth.show_by_frame(curves, *self._frames)
        else:
            growth.show_growing(curves, self.tail)
        number = len(np.unique(drawing.curve_attributes["seed"]))
        self.report({"INFO"}, f"'{curves.name}' follows {number} starting points over the scene's frames")


CLASSES = (STORMFIELD_OT_pathlines,)
