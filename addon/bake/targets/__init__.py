# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake can write: one module for each target, in the order in which they are written."""

from ..task import TargetName
from .exr import FlowMaps
from .frames import FlowingTexture
from .morse import MorseCache
from .target import Target
from .vdb import Bands

#: By the words of the command line.
TARGETS: dict[TargetName, type[Target]] = {"usd": FlowingTexture, "exr": FlowMaps, "vdb": Bands, "morse": MorseCache}
