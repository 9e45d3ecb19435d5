#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Walk through the first ten minutes in Blender's window, on a screen of its own (Xvfb, xdotool, ImageMagick):
#   scripts/walk_window.sh [--out FOLDER] [STEP...]       see walk_window.py
# STORMFIELD_PACKAGES names folders of Python packages for that Blender, where it was built without what the zip brings.
set -euo pipefail
cd "$(dirname "$0")/.."
export LIBGL_ALWAYS_SOFTWARE=${LIBGL_ALWAYS_SOFTWARE:-1}
exec xvfb-run -a -s '-screen 0 1920x1080x24 +extension GLX' python3 scripts/walk_window.py "$@"
