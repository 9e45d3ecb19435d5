# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours that the artist has chosen in the preferences, for everything that is drawn in the interface."""

from ..analysis.colours import PALETTES, Colours
from ..scene.read import user_preferences

DEFAULT = user_preferences.UserPreferences().palette
#: Of design elements that are no fixed points, in every palette.
ELEMENTS = {
    "streamline": (0.90, 0.62, 0.00),
    "pathline": (0.80, 0.47, 0.65),
    "regular": (0.80, 0.82, 0.86),
    "attachment": (0.95, 0.80, 0.35),
    "separation": (0.62, 0.55, 0.95),
    "brush": (0.45, 0.80, 0.72),
}
#: Which kind of fixed point a design element's kind is drawn as.
_ROLES = {"vortex": "center", "spiral_in": "sink", "spiral_out": "source"}


def name() -> str:
    """Of the palette in the preferences."""
    chosen = user_preferences.read().palette
    return chosen if chosen in PALETTES else DEFAULT


def colours() -> Colours:
    """Of kinds of entities, sRGB."""
    return PALETTES[name()]


def kind_colour(kind: str) -> tuple[float, float, float]:
    found = colours()
    return found.get(kind, found["other"])


def element_colour(element_type: str, kind: str) -> tuple[float, float, float]:
    """type and kind as in ElementProperties."""
    if element_type == "orbit":
        return kind_colour(kind)
    if element_type == "bifurcation":
        return kind_colour({"sink": "sink", "source": "source"}.get(kind.rpartition("_")[2], "attracting"))
    if element_type != "singular":
        return ELEMENTS.get(element_type, ELEMENTS["regular"])
    return kind_colour(_ROLES.get(kind.rpartition("_")[0], kind))
