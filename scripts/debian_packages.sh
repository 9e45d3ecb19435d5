#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs those Debian packages that are missing: with names these, without those that Stormfield is built from. Without
# root or sudo it prints the one command to run.
set -euo pipefail
cd "$(dirname "$0")/.."

build=(
  build-essential cmake ninja-build ccache python3 python3-venv python3-dev
  libeigen3-dev libtbb-dev libgtest-dev libbenchmark-dev
  # what Blender as a Python module loads
  libx11-6 libxrender1 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1
)
packages=("$@")
[ $# -gt 0 ] || packages=("${build[@]}")

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

install="apt-get install -y --no-install-recommends ${missing[*]}"
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! sudo -n true 2>/dev/null; then
    echo "Stormfield needs Debian packages that are not installed. Please run:" >&2
    echo "  sudo $install" >&2
    exit 1
  fi
  as_root=sudo
fi
scripts/step.sh packages "installing ${#missing[@]} Debian packages, a minute or two: ${missing[*]}" \
  $as_root sh -c "apt-get update -qq && DEBIAN_FRONTEND=noninteractive $install"
