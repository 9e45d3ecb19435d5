# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/formats.md says what the program writes: attributes, headers, manifests, designs, the JSON of the commands."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
FORMATS = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
#: What every JSON of the command line carries; the page says it once.
EVERYWHERE = {"schema", "read", "mesh", "lam", "seconds"}


def sources(folder: str) -> str:
    return "".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / folder).rglob("*.py")))


def section(title: str) -> str:
    """The text of one section of the page."""
    return re.split(r"^## ", FORMATS.split(f"\n## {title}\n", 1)[1], maxsplit=1, flags=re.M)[0]


def first_column(text: str) -> list[str]:
    """Names in the first column of every table."""
    rows = re.findall(r"^\| (`[^|]*) \|", text, flags=re.M)
    return [name for row in rows for name in re.findall(r"`([^`]+)`", row)]


def test_attributes_are_those_of_the_code():
    written = set(re.findall(r'"(sf_[a-z_]+)"', sources("addon")))
    described = set(re.findall(r"`(sf_[a-z_]+)`", FORMATS))
    assert described == written


def test_headers_are_those_of_the_code():
    for target, title in (("exr", "EXR flow maps"), ("vdb", "VDB volumes")):
        code = (ROOT / "addon" / "bake" / "targets" / f"{target}.py").read_text(encoding="utf-8")
        assert {name for name in first_column(section(title)) if ":" in name} == set(
            re.findall(r'"(stormfield:\w+)"', code)
        )


def test_the_manifest_has_the_keys_of_the_page():
    from stormfield.cache.plan import MeshIdentity, Plan

    plan = Plan("usd", "lambda", (0.0, 1.0), MeshIdentity("0" * 64, 3, 1), {})
    described = set(first_column(section("Manifest"))) - {"frames"}
    assert described == (set(plan.to_json()) | {"files"}) - {"schema"}
    assert plan.to_json()["schema"] in section("Manifest")


def test_kinds_have_the_numbers_of_the_page():
    from stormfield.analysis.colours import KIND_COLOURS
    from stormfield.bake.targets.morse import KINDS

    rows = re.findall(r"^\| (\d+) \| (\w+) \|$", section("Morse sets over λ"), flags=re.M)
    assert [name for _, name in sorted(rows, key=lambda row: int(row[0]))] == list(KINDS)
    names = re.search(r"\| 0 \| 1 .*\n.*\n\| (.*) \|", section("Analysis objects in Blender"))
    assert names is not None
    assert names[1].split(" | ") == [*KIND_COLOURS, "creation", "annihilation", "hopf"]


def test_the_design_of_the_page_is_one():
    from stormfield.model.design import Design

    example = re.search(r"```json\n(.*?)```", section("Design"), flags=re.S)
    assert example is not None
    Design.from_json(json.loads(example[1])).check()


@pytest.fixture(scope="module")
def wind(tmp_path_factory):
    """Wind on a coarse grid at three times."""
    path = tmp_path_factory.mktemp("wind") / "wind.npz"
    latitude, longitude = np.linspace(-90, 90, 13), np.arange(0, 360, 15.0)
    grid = np.radians(longitude)[None, :] + np.arange(3)[:, None, None]
    east = np.cos(grid) + 0.0 * latitude[None, :, None]
    np.savez(path, lat=latitude, lon=longitude, u=east, v=np.sin(grid) * np.cos(np.radians(latitude))[None, :, None])
    return path


@pytest.mark.parametrize("command", ["analyze", "track", "morse"])
def test_commands_write_the_keys_of_the_page(command, wind, tmp_path):
    from stormfield.cli import main

    out = tmp_path / "out.json"
    assert main([command, str(wind), "--sphere-faces", "320", "--json", str(out)]) == 0
    written = json.loads(out.read_text(encoding="utf-8"))
    row = re.search(rf"^\| `stormfield {command}` \| `([^`]+)` \| (.*) \|$", FORMATS, flags=re.M)
    assert row is not None
    assert written["schema"] == row[1]
    assert set(written) - EVERYWHERE == set(re.findall(r"`(\w+)`", row[2]))
    assert set(written) >= EVERYWHERE
