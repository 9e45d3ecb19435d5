"""The order of the folders, as tests/layering/test_layering.py states and checks it: as a table and as a picture."""

import ast
from collections.abc import Set
from pathlib import Path

TEST = Path(__file__).parents[3] / "tests" / "layering" / "test_layering.py"
#: Tables of that file by the name the pages use, and the folders that see everything and would hide the rest.
TABLES = {"native": "NATIVE", "addon": "ADDON"}
SEE_ALL = {"native": {"bindings"}, "addon": {"__init__", "__main__"}}

#: Of the picture, in pixels: distance of levels and lanes, height of a box, width of a letter.
LEVEL, LANE, BOX, LETTER = 46, 118, 26, 7.4


def allowed(part: str) -> dict[str, set[str]]:
    """Each folder and what it may use besides itself. Raises KeyError when the test has no such table."""
    found: dict[str, dict[str, list[str]]] = {}
    for statement in ast.parse(TEST.read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            try:  # the tables are made of lists and of earlier tables; whatever else there is, is not ours
                value = eval(compile(ast.Expression(statement.value), str(TEST), "eval"), {"__builtins__": {}}, found)
            except Exception:
                continue
            found[statement.targets[0].id] = value
    return {folder: set(others) for folder, others in found[TABLES[part]].items()}


def arrows(part: str, without: Set[str] = frozenset()) -> dict[str, list[str]]:
    """Each folder and the folders it uses that none of the others brings along, in the order of the table."""
    table = {folder: others - without for folder, others in allowed(part).items() if folder not in without}
    return {
        folder: [other for other in table if other in others and not any(other in table[each] for each in others)]
        for folder, others in table.items()
    }


def table(part: str) -> list[tuple[str, str]]:
    return [(folder, ", ".join(others) or "nothing") for folder, others in arrows(part).items()]


def picture(part: str) -> str:
    """SVG: what a folder uses stands above it."""
    drawn = arrows(part, without=SEE_ALL[part])
    places = _places(drawn)
    middle = {folder: 70 + LANE * lane for folder, (_, lane) in places.items()}
    top = {folder: 4 + LEVEL * level for folder, (level, _) in places.items()}
    lines, boxes = [], []
    for folder, others in drawn.items():
        x, y = middle[folder], top[folder]
        for other in others:
            start, bend = top[other] + BOX, (top[folder] - top[other] - BOX) / 2
            lines.append(
                f'<path d="M{middle[other]} {start} C{middle[other]} {start + bend} {x} {y - bend} {x} {y}" '
                'fill="none" stroke="currentColor" stroke-opacity="0.5"/>'
            )
        width = 16 + LETTER * len(folder)
        boxes.append(
            f'<rect x="{x - width / 2:.0f}" y="{y}" width="{width:.0f}" height="{BOX}" rx="5" '
            'fill="var(--color-background-secondary)" stroke="currentColor"/>'
            f'<text x="{x}" y="{y + 17}" text-anchor="middle">{folder}</text>'
        )
    size = f"{max(middle.values()) + 70} {max(top.values()) + BOX + 4}"
    return (
        f'<svg viewBox="0 0 {size}" width="{size.split()[0]}" style="max-width: 100%" role="img" '
        'font-size="12" fill="currentColor"><title>What each folder uses stands above it</title>'
        f"{''.join(lines + boxes)}</svg>"
    )


def _places(drawn: dict[str, list[str]]) -> dict[str, tuple[int, int]]:
    """Level and lane. A level is the longest chain above; a folder stands in the lane of the lowest one that it uses,
    or in the first to the right that is free from there down."""
    levels: dict[str, int] = {}
    for folder in drawn:
        levels[folder] = max((levels[other] + 1 for other in drawn[folder]), default=0)
    places: dict[str, tuple[int, int]] = {}
    taken: set[tuple[int, int]] = set()
    for folder, others in drawn.items():
        lowest = max(others, key=lambda other: levels[other], default=None)
        first, lane = (levels[lowest] + 1, places[lowest][1]) if lowest else (levels[folder], 0)
        column = range(first, levels[folder] + 1)
        while any((level, lane) in taken for level in column):
            lane += 1
        places[folder] = levels[folder], lane
        taken |= {(level, lane) for level in column}
    return places
