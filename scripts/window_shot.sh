#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Photograph Blender's window with the add-on in it. Run under a screen of 1600x1000 (xvfb-run), with xdotool and import:
#   scripts/window_shot.sh PICTURE PNG [SECONDS]       PICTURE as in window_shot.py
set -euo pipefail
STORMFIELD_SHOT=$1 blender --factory-startup --gpu-backend opengl -P "$(dirname "$0")/window_shot.py" &
pid=$!
sleep "${3:-40}"
xdotool mousemove "${STORMFIELD_TAB_X:-1299}" "${STORMFIELD_TAB_Y:-169}" click 1   # the Stormfield tab of the sidebar
sleep 4
if [ "$1" = draw ]; then   # one stroke over the forehead
  xdotool mousemove 560 400 mousedown 1
  for step in $(seq 1 24); do xdotool mousemove $((560 + step * 9)) $((400 - (step * (24 - step)) / 3)); sleep 0.05; done
  xdotool mouseup 1
fi
xdotool mousemove 600 760
sleep 3
import -window root "$2"
kill "$pid"
wait "$pid" 2>/dev/null || true
