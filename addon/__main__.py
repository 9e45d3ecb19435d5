# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m stormfield"""

from .cli import run

if __name__ == "__main__":
    run()
