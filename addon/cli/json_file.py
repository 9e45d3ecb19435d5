# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON that a command is given as a file."""

import json
from pathlib import Path
from typing import Any

from ..model.errors import InputError


def read_json(path: Path) -> Any:
    """What the file holds. Raises InputError that names the file where there is none, or it is not JSON."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the name") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from error
    except ValueError as error:
        raise InputError(f"{path}: is not JSON ({error})") from error
