#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The picture of the gas engine's ECG beside its MCG in the README, docs/pictures/graphs.png. STORMFIELD_DATA names the
# folder that holds the data set gasEngineV.t.
set -euo pipefail
data=$(realpath "${STORMFIELD_DATA:?names the folder that holds gasEngineV.t}/gasEngineV.t")
cd "$(dirname "$0")/.."
pictures=$(mktemp -d)
trap 'rm -rf "$pictures"' EXIT
.venv/bin/stormfield analyze "$data" --json - --image "$pictures/ecg.png" > "$pictures/ecg.json"
.venv/bin/stormfield morse "$data" --refine --json - --image "$pictures/mcg.png" > "$pictures/mcg.json"
convert "$pictures/ecg.png" "$pictures/mcg.png" -resize 1600x -append -colors 250 docs/pictures/graphs.png
