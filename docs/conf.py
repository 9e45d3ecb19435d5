# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx: the site in build/docs/html. `make docs` builds it; warnings are errors."""

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(Path(__file__).parent / "extension"))

project = "Stormfield"
author = "Stormfield contributors"
copyright = "Stormfield contributors, GPL-3.0-or-later"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]

extensions = ["myst_parser", "stormfield_docs"]
exclude_patterns = ["extension"]
nitpicky = True

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "amsmath", "attrs_inline"]
myst_heading_anchors = 4
myst_links_external_new_tab = False

html_theme = "furo"
html_title = f"Stormfield {version}"
html_copy_source = False
html_show_sourcelink = False
html_static_path = ["static"]
html_css_files = ["stormfield.css"]
# Formulas are drawn by the reader's browser; the site needs no other server.
html_math_renderer = "mathjax"
