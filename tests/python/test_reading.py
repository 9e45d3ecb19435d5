# SPDX-License-Identifier: GPL-3.0-or-later
"""What --vector means, what is said of data, and times as λ."""

import json

import numpy as np
import pytest
from stormfield.model.errors import InputError
from stormfield.readers import ArrayInfo, Reading
from stormfield.readers.choice import chosen_arrays
from stormfield.readers.field_data import lambdas_of

OFFERED = [
    ArrayInfo("WSS", "points", 3, "Pa"),
    ArrayInfo("WSS", "cells", 3),
    ArrayInfo("Velocity, mean (m/s)", "points", 3),
    ArrayInfo("Wall Shear X", "points", 1),
    ArrayInfo("a", "points", 1),
    ArrayInfo("a,b", "points", 1),
    ArrayInfo("c", "points", 1),
]


@pytest.mark.parametrize(
    ("vector", "names"),
    [
        ("WSS", ["points:WSS"]),
        ("cells:WSS", ["cells:WSS"]),
        ("Velocity, mean (m/s)", ["points:Velocity, mean (m/s)"]),
        (" Wall Shear X , a,c", ["points:Wall Shear X", "points:a", "points:c"]),
        ("a,b,c", ["points:a,b", "points:c"]),
        ("a,a,b,c", ["points:a", "points:a,b", "points:c"]),
    ],
)
def test_vector_names_arrays_whatever_characters_their_names_have(vector, names):
    assert [f"{a.location}:{a.name}" for a in chosen_arrays(vector, OFFERED, "w.vtp")] == names


@pytest.mark.parametrize(
    ("vector", "unknown"), [("nonsense", "nonsense"), ("a,q,c", "q"), ("", ""), ("faces:WSS", "faces:WSS")]
)
def test_an_array_that_is_not_there_is_named_with_all_that_are(vector, unknown):
    with pytest.raises(InputError) as fault:
        chosen_arrays(vector, OFFERED, "w.vtp")
    assert str(fault.value).startswith(
        f"w.vtp: has no array '{unknown}'; choose from: WSS (points, 3 components, Pa), "
    )
    assert "WSS (cells, 3 components)" in str(fault.value)


def test_the_line_and_the_json_say_the_same():
    read = Reading(
        files=("w_0.vtp", "w_1.vtp", "w_2.vtp"),
        arrays=(OFFERED[1],),
        choices=tuple(OFFERED),
        selected={"level": 850},
        times=(0.0, 2.5),
        time_unit="s",
        changes={"points welded": 12, "cells filled": 0},
        notes=("the last block is left out",),
        tangent_share=0.98,
    )
    assert read.line() == (
        "w_0.vtp to w_2.vtp (3 files): WSS (cells, 3 components); level 850; 2 times, 0.0 to 2.5 s; 12 points welded; "
        "tangent share 0.98; the last block is left out"
    )
    said = json.loads(json.dumps(read.to_json(), allow_nan=False))
    assert said["changes"] == {"points welded": 12} and said["times"] == [0.0, 2.5]
    assert said["arrays"] == [{"name": "WSS", "location": "cells", "components": 3, "unit": ""}]
    assert len(said["choices"]) == len(OFFERED)


def test_lambda_is_linear_in_time_and_gaps_stay():
    assert np.allclose(lambdas_of([0, 6, 12, 36, 42, 48], "w"), np.array([0, 6, 12, 36, 42, 48]) / 48)
    assert np.array_equal(lambdas_of([7.0], "w"), [0.0])


@pytest.mark.parametrize("times", [[0, 1, 1], [0, 2, 1], [0, np.nan]])
def test_times_that_do_not_increase_are_refused(times):
    with pytest.raises(InputError, match="w: time"):
        lambdas_of(times, "w")
