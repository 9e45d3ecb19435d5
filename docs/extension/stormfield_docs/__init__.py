# SPDX-License-Identifier: GPL-3.0-or-later
"""What the site takes from the program itself, so that it is always current.

    ```{settings} SolveProperties     the settings of a property group, by name
    samples lambda_weight
    ```
    ```{operators}                    operators by the last part of their name
    solve cancel_job
    ```
    ```{arrows} native                the order of folders that tests/layering checks

The pages reference/commands.md and reference/python/*.md are written before Sphinx reads its sources.
"""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx


def setup(app: "Sphinx") -> dict[str, bool]:
    # Here, so that the tests read the rest without Sphinx.
    from . import directives, generate

    for name, directive in directives.DIRECTIVES.items():
        app.add_directive(name, directive)
    app.connect("builder-inited", lambda app: generate.write_pages(Path(app.srcdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
