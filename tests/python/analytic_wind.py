# SPDX-License-Identifier: GPL-3.0-or-later
"""Winds whose answer is known: a strong storm on a westerly has four fixed points, poles, storm and saddle."""

import numpy as np


def in_space(latitude, longitude):
    """Degrees (broadcast) → place, eastward, northward, each (..., 3)."""
    phi, theta = np.broadcast_arrays(np.radians(latitude), np.radians(longitude))
    zero = np.zeros_like(phi)
    place = np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)], axis=-1)
    east = np.stack([-np.sin(theta), np.cos(theta), zero], axis=-1)
    north = np.stack([-np.sin(phi) * np.cos(theta), -np.sin(phi) * np.sin(theta), np.cos(phi)], axis=-1)
    return place, east, north


def components(wind, latitude, longitude):
    """u, v of wind(places (..., 3)) → (..., 3)."""
    place, east, north = in_space(latitude, longitude)
    vectors = wind(place)
    return (vectors * east).sum(-1), (vectors * north).sum(-1)


def rotation(axis):
    """The rigid rotation about an axis, whose length is the speed at its equator."""
    return lambda place: np.cross(axis, place)


def storm(latitude, longitude, speed=40.0, radius=0.1, westerly=10.0):
    """A storm that turns left at a place, on a westerly; m/s, radius in radians."""
    centre = in_space(latitude, longitude)[0]

    def wind(place):
        distance = ((place - centre) ** 2).sum(-1, keepdims=True)
        return westerly * np.cross([0.0, 0.0, 1.0], place) + speed / radius * np.exp(
            -distance / (2.0 * radius**2)
        ) * np.cross(centre, place)

    return wind


def grid(step=2.0, north_first=True):
    """latitude, longitude of the whole globe."""
    latitude = np.arange(-90.0, 90.0 + step / 2, step)
    return latitude[::-1] if north_first else latitude, np.arange(0.0, 360.0, step)
