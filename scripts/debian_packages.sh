#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian packages that Stormfield is built from and that are missing. Without root or sudo it prints the
# one command to run.
set -euo pipefail

packages=(
  build-essential clang-19 cmake ninja-build ccache python3 python3-venv python3-dev
  libeigen3-dev libtbb-dev libgtest-dev libbenchmark-dev ffmpeg
  # what Blender as a Python module loads
  libx11-6 libxrender1 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

quietly() {  # what a command printed is of interest when it failed
  local log status=0
  log=$(mktemp)
  "$@" >"$log" 2>&1 </dev/null || status=$?
  [ $status -eq 0 ] || cat "$log" >&2
  rm -f "$log"
  return $status
}

install="apt-get install -y --no-install-recommends ${missing[*]}"
if [ "$(id -u)" -eq 0 ]; then
  echo "installing Debian packages: ${missing[*]}"
  quietly apt-get update -qq
  quietly env DEBIAN_FRONTEND=noninteractive $install
elif sudo -n true 2>/dev/null; then
  echo "installing Debian packages: ${missing[*]}"
  quietly sudo apt-get update -qq
  quietly sudo DEBIAN_FRONTEND=noninteractive $install
else
  echo "Stormfield needs Debian packages that are not installed. Please run:" >&2
  echo "  sudo $install" >&2
  exit 1
fi
