# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of Morse decompositions, and what the last one was made with."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from ..session import morse_preview, morse_state
from .overridable import overridable

METHODS = (
    (
        "geometry",
        "Directions",
        "By the direction in which the flow crosses each edge (geometry map): fast, and Refine divides even faces",
        0,
    ),
    ("tau", "Flow Time", "By where the flow takes each face in a time τ (tau map): finer, the longer", 1),
    (
        "spatial",
        "Flow Length",
        "By where the flow takes each face over a length (spatial tau map): even where the flow is slow",
        2,
    ),
)


def _preview(self, _context) -> None:
    if self.live:
        morse_preview.request(self.id_data)
    else:
        morse_preview.stop(self.id_data)


def _simplify(self, _context) -> None:
    morse_state.simplify_later(self.id_data)


@overridable
class MorseProperties(bpy.types.PropertyGroup):
    method: EnumProperty(
        name="Method",
        description="How the flow between faces is found",
        items=METHODS,
        default="geometry",
        update=_preview,
    )
    tau: FloatProperty(
        name="Flow Time",
        description="Time τ for which every face is moved along the flow (seconds): longer separates regions that lie "
        "close together and takes longer; 0 takes a starting value from mesh and field",
        min=0.0,
        soft_max=10.0,
        default=0.0,
        precision=6,
        step=1,
        update=_preview,
    )
    length: FloatProperty(
        name="Flow Length",
        description="Arc length over which every face is moved along the flow (mesh units, object space); 0 takes a "
        "starting value from mesh and field",
        min=0.0,
        soft_max=10.0,
        default=0.0,
        precision=6,
        step=1,
        update=_preview,
    )
    eps: FloatProperty(
        name="Data Error",
        description="The regions hold for every field that differs from this one by at most this fraction of the mean "
        "speed (ε, percent); for the method Directions, refined or not",
        subtype="PERCENTAGE",
        min=0.0,
        max=100.0,
        default=0.0,
        precision=2,
        update=_preview,
    )
    live: BoolProperty(
        name="Live Preview",
        description="Show coarse regions at once whenever λ or a setting changes; Find Regions makes them in full",
        default=False,
        update=_preview,
    )
    tau_max: FloatProperty(
        name="Longest Flow Time",
        description="Refinement doubles the flow time τ inside a region up to this multiple of the first one (factor)",
        min=1.0,
        soft_max=256.0,
        max=1e6,
        default=64.0,
        precision=0,
    )
    persistence: BoolProperty(
        name="Measure Robustness",
        description="Find for each refined region the error ε at which it merges with another (its persistence), to a "
        "factor of 2: takes some twenty times as long as the regions alone",
        default=False,
    )
    seconds: FloatProperty(
        name="Time Limit",
        description="Refinement ends after this time (seconds) and keeps what it has",
        min=0.1,
        soft_max=60.0,
        default=10.0,
        precision=1,
    )
    simplify: FloatProperty(
        name="Simplify",
        description="Merge regions that errors up to this fraction of the mean speed (percent) would merge; refined "
        "ones keep the pieces of edges they were found with",
        subtype="PERCENTAGE",
        min=0.0,
        max=100.0,
        default=0.0,
        precision=2,
        update=_simplify,
    )


CLASSES = (MorseProperties,)
