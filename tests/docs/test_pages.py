"""The documentation says what is there: links and anchors lead somewhere, named files exist, every setting has a place.

Pages are read as text; the site itself is built by `make docs`, which takes warnings as errors.
"""

import re
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS / "extension"))
from stormfield_docs import addon, arrows, commands, generate, python_reference  # noqa: E402

#: Folders whose files pages and comments may name.
NAMED = ("native", "addon", "tests", "docs", "scripts", "blend_examples", "pipelines", "cmake")


@cache
def pages() -> dict[str, str]:
    """Text of every page by its path in the repository, also of those that are written when the site is built."""
    kept = [path for path in sorted(DOCS.rglob("*.md")) if "extension" not in path.parts]
    kept += [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "blend_examples" / "README.md"]
    found = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in kept}
    return found | {f"docs/{name}": text for name, text in generate.pages().items()}


def without_code(text: str) -> str:
    """The text without fenced code; the bodies of directives go as well."""
    return re.sub(r"^ *(```+|~~~+).*?^ *\1 *$", "", text, flags=re.M | re.S)


def slug(title: str) -> str:
    """The anchor of a heading, as GitHub and MyST make it."""
    title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title)
    return re.sub(r"[^\w\- ]", "", title.replace("\\", "").lower()).strip().replace(" ", "-")


def anchors(text: str) -> set[str]:
    """Headings, (labels)=, settings and operators."""
    found = {slug(title) for title in re.findall(r"^#+ +(.+?) *$", without_code(text), flags=re.M)}
    found |= set(re.findall(r"^\(([\w-]+)\)=$", text, flags=re.M))
    for group, names in re.findall(r"^```\{settings\} (\w+)\n(.*?)^```", text, flags=re.M | re.S):
        found |= {addon.anchor_of_setting(group, name) for name in names.split()}
    for names in re.findall(r"^```\{operators\}\n(.*?)^```", text, flags=re.M | re.S):
        found |= {addon.anchor_of_operator(name) for name in names.split()}
    return found


def links(text: str) -> list[str]:
    """Targets of links and pictures that are not on other servers."""
    targets = re.findall(r"!?\[[^\]]*\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", without_code(text)))
    return [target for target in targets if not re.match(r"[a-z]+:", target)]


def broken_links(page: str, texts: dict[str, str]) -> list[str]:
    broken = []
    for target in links(texts[page]):
        name, _, anchor = target.partition("#")
        path = page if not name else _normal(f"{page.rpartition('/')[0]}/{name}")
        absent = path not in texts and not (ROOT / path).exists()
        if absent or (anchor and path in texts and anchor not in anchors(texts[path])):
            broken.append(target)
    return broken


def missing_files(text: str) -> list[str]:
    """Files and folders named in `code` or in comments that do not exist. A name may have * and {a,b}."""
    named = re.findall(rf"(?<![\w/.-])((?:{'|'.join(NAMED)})/[\w./*{{}},-]*[\w/*}}])", text)
    return [name for name in named if not all(_exists(each) for each in _spelled_out(name))]


def _exists(name: str) -> bool:
    return any(True for _ in ROOT.glob(name.rstrip("/"))) or f"{name}" in pages()


def _spelled_out(name: str) -> list[str]:
    match = re.match(r"(.*?)\{([^{}]*)\}(.*)", name)
    if match is None:
        return [name]
    return [each for word in match[2].split(",") for each in _spelled_out(match[1] + word + match[3])]


def _normal(path: str) -> str:
    parts: list[str] = []
    for part in path.split("/"):
        if part == "..":
            parts.pop()
        elif part not in {"", "."}:
            parts.append(part)
    return "/".join(parts)


def code_files() -> list[Path]:
    folders = ("native", "addon", "tests", "scripts", "blend_examples")
    found = [path for folder in folders for path in sorted((ROOT / folder).rglob("*"))]
    return [path for path in found if path.suffix in {".h", ".cpp", ".py", ".sh"} and path != Path(__file__)]


def decisions_cited(text: str) -> list[str]:
    """Numbers of the decisions that a comment cites."""
    cited = re.findall(r"docs/architecture\.md,\s*(?://\s*)?decisions? ([\d, and]+)", text)
    return [number for each in cited for number in re.findall(r"\d+", each)]


def test_links_lead_somewhere():
    broken = {page: found for page in pages() if (found := broken_links(page, pages()))}
    assert not broken


def test_pages_name_files_that_exist():
    missing = {page: found for page, text in pages().items() if (found := missing_files(text))}
    assert not missing


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
    groups = addon.settings().values()
    drawn = {setting.anchor for group in groups for setting in group.values() if setting.name in shown_names()}
    assert drawn - hidden() <= named


def hidden() -> set[str]:
    """Settings that no panel draws although another group's setting of the same name is drawn."""
    names = {"EntityItem": tuple(addon.settings()["EntityItem"]), "EntityList": ("lam", "shown_field")}
    names["FieldProperties"] = ("enabled",)
    return {addon.anchor_of_setting(group, name) for group, listed in names.items() for name in listed}


def shown_names() -> frozenset[str]:
    """Also the names that panels build: the list in a loop of the Look panel, tau or length."""
    loops = {name for name in addon.settings()["AnalysisProperties"] if name.startswith("show_")}
    return addon.names_in_panels() | loops | {"tau", "length"}


@pytest.mark.parametrize("part", ["native"])
def test_the_arrows_can_be_shown(part):
    assert arrows.table(part)


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
