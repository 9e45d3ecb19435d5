# SPDX-License-Identifier: GPL-3.0-or-later
"""The target one_definition finds two classes of one name: its own options, on two small files."""

import re
import subprocess
from pathlib import Path

CMAKE = Path(__file__).parents[2] / "native" / "CMakeLists.txt"


def join(folder: Path, *texts: str) -> str:
    """What the compiler says when it joins these files as the target joins the core's."""
    objects = []
    for number, text in enumerate(texts):
        source = folder / f"{number}.cpp"
        source.write_text(text)
        objects.append(source.with_suffix(".o"))
        subprocess.run(["g++", "-O0", "-flto", "-c", source, "-o", objects[-1]], check=True)
    options = re.search(r"CMAKE_CXX_COMPILER} (-r -flto .*) \$", CMAKE.read_text())
    assert options
    command = ["g++", *options[1].split(), *objects, "-o", folder / "joined.o"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr


CROSSING = "struct Crossing {{ {members} }};\n{type} {name}() {{ Crossing c{{}}; return c.first; }}\n"


def test_two_classes_of_one_name_are_refused(tmp_path):
    first = CROSSING.format(members="bool first, last;", type="bool", name="f")
    other = CROSSING.format(members="double first, last, length;", type="double", name="g")
    assert "One Definition Rule" in join(tmp_path, first, other)
    assert not join(tmp_path, first, first.replace("f()", "g()"))
