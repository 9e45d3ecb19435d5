# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages as text: what they link to, name and define. The tests use it; the site itself is built by Sphinx."""

import re
from functools import cache
from pathlib import Path

from . import addon, generate

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
#: Folders whose files pages and comments may name.
NAMED = ("native", "addon", "tests", "docs", "scripts", "blend_examples", "pipelines", "cmake")


@cache
def written_pages() -> dict[str, str]:
    """Text of every page that is kept in the repository, by its path there."""
    found = [path for path in sorted(DOCS.rglob("*.md")) if "extension" not in path.parts]
    found += [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "blend_examples" / "README.md"]
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in found}


@cache
def pages() -> dict[str, str]:
    """Also those that are made when the site is built."""
    return written_pages() | {f"docs/{name}": text for name, text in generate.pages().items()}


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


def cited_tests(text: str) -> list[str]:
    """C++ tests named as Suite.Name."""
    return re.findall(r"`([A-Z]\w+\.[A-Z]\w+)`", text)


def decisions_cited(text: str) -> list[str]:
    """Numbers of the decisions that a comment cites."""
    cited = re.findall(r"docs/architecture\.md,\s*(?://\s*)?decisions? ([\d, and]+)", text)
    return [number for each in cited for number in re.findall(r"\d+", each)]
