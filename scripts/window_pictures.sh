#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The pictures of the analysis in the README, docs/pictures/STATE.png, from Blender's window. Run as window_shot.sh:
#   scripts/window_pictures.sh [STATE...]
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- analyzed graph paths morse
for state in "$@"; do
  scripts/window_shot.sh "$state" "out/$state.png" "${SECONDS_TO_WAIT:-75}"
  [ "$state" = paths ] && height=948 || height=878   # the timeline is part of this picture
  convert "out/$state.png" -crop "1314x$height+0+28" +repage -resize 1100x -dither None -colors 200 "docs/pictures/$state.png"
done
