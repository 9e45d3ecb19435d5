# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that are none: those the file declares, and those it does not declare but no wind can be."""

from __future__ import annotations

import numpy as np

from .vocabulary import attributes

#: No wind or current on the earth is faster, m/s.
FASTEST = 500.0
#: Numbers that programs write for "no value".
MARKS = (999.0, 999.9, 9999.0, 9999.9, 99999.0, 999999.0, 32767.0, 32768.0, 32766.0, 1e10, 1e15, 1e20, 1e30, 1e35, 1e36)
#: Any number as large as this is a mark.
LARGE_MARK = 1e10
#: A mark is one where all other values are smaller by this factor.
CLEAR = 3.0


def without_declared(variable, values: np.ndarray) -> np.ndarray:
    """NaN where a value is outside the valid range of its variable. xarray has put it where _FillValue and
    missing_value stand."""
    known = attributes(variable)
    scale, offset = float(known.get("scale_factor", 1.0)), float(known.get("add_offset", 0.0))
    limits = known.get("valid_range")
    low, high = limits if limits is not None else (known.get("valid_min"), known.get("valid_max"))
    packed = np.dtype(known.get("dtype", float)).kind in "iu"
    for limit, outside in ((low, np.less), (high, np.greater)):
        if limit is None or not np.isfinite(float(limit)):
            continue
        # The limits of packed data are packed, unless they are written as real numbers.
        stored = packed and np.asarray(limit).dtype.kind in "iu"
        bound = float(limit) * scale + offset if stored else float(limit)
        values = np.where(outside(values, bound), np.nan, values)
    return values


def undeclared(u: np.ndarray, v: np.ndarray, speed: float | None) -> tuple[np.ndarray, list[float]]:
    """Where a component is no value, beside those that are not finite, and which numbers stand there. speed: metres per
    second of one unit, None for data that are no speed."""
    found = np.zeros(u.shape, bool)
    marks: set[float] = set()
    for values in (u, v):
        size = np.abs(values)
        wrong = np.isfinite(size) & (size * speed > FASTEST) if speed is not None else np.zeros(size.shape, bool)
        wrong |= _marked(values, size, wrong)
        marks |= {float(value) for value in np.unique(values[wrong])[:4]}
        found |= wrong
    return found, sorted(marks)


def _marked(values: np.ndarray, size: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Where a number stands that programs write for no value, and that is far from all others."""
    largest = float(np.max(size, initial=0.0, where=np.isfinite(size) & ~known))
    mark = next((mark for mark in MARKS if np.isclose(largest, mark, rtol=1e-6)), None)
    if mark is None and largest < LARGE_MARK:
        return np.zeros(values.shape, bool)
    there = size >= largest * (1.0 - 1e-6)
    others = float(np.max(size, initial=0.0, where=np.isfinite(size) & ~known & ~there))
    sure = (there.sum() > 1 or largest >= LARGE_MARK) and others * CLEAR < largest
    return there if sure else np.zeros(values.shape, bool)
