#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Brings CMake and Ninja into build/tools/bin where the system has none, or a CMake that is too old: Ubuntu 22.04 has
# 3.22. The Makefile puts that folder first on PATH. What is new enough is left as it is.
set -euo pipefail
cd "$(dirname "$0")/.."

required=$(sed -n 's/^cmake_minimum_required(VERSION \([0-9.]*\)).*/\1/p' CMakeLists.txt)
tools=build/tools

enough() {  # whether cmake at $1 runs and is as new as required
  local found
  found=$("$1" --version 2>/dev/null | sed -n 's/^cmake version \([0-9.]*\).*/\1/p')
  [ -n "$found" ] && [ "$(printf '%s\n' "$required" "$found" | sort -V | head -n 1)" = "$required" ]
}

if { enough cmake || enough "$tools/bin/cmake"; } && { command -v ninja || [ -x "$tools/bin/ninja" ]; } >/dev/null; then
  exit 0
fi

mkdir -p "$tools/bin"
scripts/step.sh tools "CMake and Ninja come into $tools (30 MB): this system has no CMake $required" \
  bash -c "python3 -m venv $tools/python && $tools/python/bin/python -m pip install --quiet 'cmake>=$required' ninja" || {
  echo "They could not be downloaded. Please install CMake $required or newer and Ninja, and make again." >&2
  exit 1
}
# The folder has these programs alone: another python3 must not come first on PATH.
for program in cmake ctest ninja; do ln -sf "../python/bin/$program" "$tools/bin/$program"; done
