# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the stub package of the compiled core, for type checkers and readers.

stubs.py MODULE FOLDER: from the module's file, its signatures and docstrings, to FOLDER/__init__.pyi
"""

import importlib
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def main(module: Path, folder: Path) -> None:
    name = module.name.split(".")[0]
    sys.path.insert(0, str(module.parent))
    importlib.import_module(name)  # a module that cannot be loaded says why
    with tempfile.TemporaryDirectory() as made:
        code = f"import sys; sys.path.insert(0, {str(module.parent)!r}); from pybind11_stubgen import main; main()"
        command = [sys.executable, "-c", code, name, "--output-dir", made, "--exit-code"]
        command += [
            "--ignore-unresolved-names",
            r"numpy\.bool",
        ]  # NumPy before 2, which Blender 4.5 has, lacks the name
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode:
            sys.exit(f"pybind11-stubgen cannot read {module}:\n{run.stdout}{run.stderr}")
        text = (Path(made) / f"{name}.pyi").read_text(encoding="utf-8")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "__init__.pyi").write_text(polished(text), encoding="utf-8")


def polished(text: str) -> str:
    """The generator's text, as it would be written by hand."""
    text = text.replace("typing.SupportsFloat | typing.SupportsIndex", "float")
    text = text.replace("typing.SupportsInt | typing.SupportsIndex", "int")
    # pybind11 takes None for any object whose default is None, and does not say so.
    text = re.sub(r"(: \w+) = None\b", r"\1 | None = None", text)
    return re.sub(r"[ \t]+$", "", text, flags=re.M)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
