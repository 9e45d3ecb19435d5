# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages that are written before Sphinx reads its sources; they are not kept in the repository."""

from pathlib import Path

from . import commands, python_reference


def pages() -> dict[str, str]:
    """Text by path relative to docs/."""
    return {"reference/commands.md": commands.page(), **python_reference.pages()}


def write_pages(docs: Path) -> None:
    """Unchanged pages are left alone, so that Sphinx does not read them again."""
    for name, text in pages().items():
        path = docs / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
