# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation says what is there: links and anchors lead somewhere, named files exist, every setting has a place.

Pages are read as text; the site itself is built by `make docs`, which takes warnings as errors.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "extension"))
from stormfield_docs import addon, arrows, commands, python_reference  # noqa: E402
from stormfield_docs.pages import anchors, broken_links, cited_tests, decisions_cited, missing_files, pages, slug  # noqa: E402


def code_files() -> list[Path]:
    folders = ("native", "addon", "tests", "scripts", "blend_examples")
    found = [path for folder in folders for path in sorted((ROOT / folder).rglob("*"))]
    return [path for path in found if path.suffix in {".h", ".cpp", ".py", ".sh"} and path != Path(__file__)]


def test_links_lead_somewhere():
    broken = {page: found for page in pages() if (found := broken_links(page, pages()))}
    assert not broken


def test_pages_name_files_that_exist():
    missing = {page: found for page, text in pages().items() if (found := missing_files(text))}
    assert not missing


@pytest.mark.parametrize("page", ["package", "native"])
def test_the_examples_of_the_python_reference_run(page):
    example = re.search(r"```python\n(.*?)```", pages()[f"docs/reference/python-{page}.md"], flags=re.S)
    assert example is not None
    found: dict = {}
    exec(example[1], found)
    assert found["kinds"] == ["source"] if page == "native" else found["vectors"].shape[1:] == (3,)


def test_commands_on_pages_are_commands():
    group = addon.command_group()
    for page, text in pages().items():
        for line in re.findall(r"^(?:\.venv/bin/)?stormfield ([a-z].*)$", text, flags=re.M):
            words = re.findall(r"--[a-z-]+|[\w.]+", line.partition("#")[0])
            assert words[0] in group.commands, f"{page}: {line}"
            known = {
                option for each in group.commands[words[0]].params for option in (*each.opts, *each.secondary_opts)
            }
            given = {word for word in words if word.startswith("--")}
            assert given <= known, f"{page}: {line}"


def test_every_algorithm_is_in_the_table():
    table = pages()["docs/algorithms/index.md"]
    names = [page.rpartition("/")[2] for page in pages() if page.startswith("docs/algorithms/")]
    assert [name for name in names if name != "index.md" and f"]({name})" not in table] == []


def test_tests_that_pages_name_exist():
    written = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests" / "native").rglob("test_*.cpp"))
    known = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST(?:_[FP])?\((\w+), (\w+)\)", written, flags=re.M)}
    for page, text in pages().items():
        if page.startswith("docs/algorithms"):
            assert set(cited_tests(text)) <= known, page


def test_words_of_the_glossary_are_those_of_the_code():
    code = "".join(path.read_text(encoding="utf-8") for path in code_files() if "tests" not in path.parts)
    words = set(re.findall(r"\w+", code))
    named = set(re.findall(r"`([A-Za-z]\w*)", pages()["docs/glossary.md"]))
    assert named - words - PATTERNS == set()


#: Of the glossary: how names are made, and no names.
PATTERNS = {"start_X"}


def test_code_cites_pages_that_exist():
    known = anchors(pages()["docs/architecture.md"])
    for path in code_files():
        text = path.read_text(encoding="utf-8")
        cited = re.findall(r"docs/[\w/]+\.md", text)
        assert all(page in pages() for page in cited), path
        assert all(f"decision-{number}" in known for number in decisions_cited(text)), path


def test_every_page_is_reached():
    """From the index by lists of pages; the names in a list may be patterns."""
    reached, waiting = set(), ["docs/index.md"]
    while waiting:
        page = waiting.pop()
        if page in reached:
            continue
        reached.add(page)
        folder = page.rpartition("/")[0]
        for body in re.findall(r"^```\{toctree\}\n(.*?)^```", pages()[page], flags=re.M | re.S):
            for name in (line for line in body.split("\n") if line and not line.startswith(":")):
                pattern = re.escape(f"{folder}/{name}.md").replace(r"\*", "[^/]*")
                waiting += [other for other in pages() if re.fullmatch(pattern, other)]
    assert reached == {page for page in pages() if page.startswith("docs/")}


def test_every_command_and_option_is_in_the_reference():
    page, group = pages()["docs/reference/commands.md"], addon.command_group()
    for name, command in group.commands.items():
        assert f"stormfield-{name}" in anchors(page)
        for option in (option for each in command.params for option in each.opts if option.startswith("-")):
            assert option in page, f"stormfield {name} {option}"


def test_the_python_reference_names_every_class_and_function():
    import stormfield_native

    page = pages()["docs/reference/python-native.md"]
    named = anchors(page)
    assert {slug(name) for name in python_reference.members_of(stormfield_native)} <= named


def test_every_operator_and_every_setting_in_a_panel_has_a_place():
    named = set().union(*(anchors(text) for page, text in pages().items() if page.startswith("docs/panels")))
    assert {operator.anchor for operator in addon.operators().values()} <= named
    curves = [setting for name in ("streamlines", "pathlines") for setting in addon.operator_settings()[name].values()]
    assert {setting.anchor for setting in curves} <= named
    shown = {s.anchor for group in addon.settings().values() for s in group.values() if addon.shown(s)}
    assert shown
    assert shown <= named


@pytest.mark.parametrize("part", ["native", "addon"])
def test_the_arrows_say_what_the_layering_test_allows(part):
    table, drawn = arrows.allowed(part), arrows.arrows(part)

    def reached(folder):
        return set(drawn[folder]).union(*(reached(other) for other in drawn[folder]))

    assert all(table[folder] <= reached(folder) for folder in table)
    assert "currentColor" in arrows.picture(part)


def test_the_checks_can_fail():
    texts = {"docs/a.md": "# One Two\n[x](b.md#three) [y](c.md) [z](#one-two)\n", "docs/b.md": "## Three!\n"}
    assert broken_links("docs/a.md", texts) == ["c.md"]
    assert broken_links("docs/a.md", {**texts, "docs/b.md": ""}) == ["b.md#three", "c.md"]
    assert missing_files("see `native/nowhere.h` and `native/base/error.h`, `docs/{index,start}.md`") == [
        "native/nowhere.h"
    ]
    assert anchors("```{settings} SolveProperties\nlambda_weight\n```\n") == {"solveproperties-lambda-weight"}
    assert decisions_cited("(docs/architecture.md, decisions 6 and 77)") == ["6", "77"]
    assert commands.escaped("a_b `c_d`") == "a\\_b `c_d`"


def test_settings_are_read_without_blender():
    """As `make docs` does; beside the bpy of these tests Blender's other modules are there too."""
    code = (
        f"import sys; sys.path.insert(0, {str(ROOT / 'docs' / 'extension')!r}); "
        "from stormfield_docs import addon; assert addon.settings(); assert 'mathutils' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
