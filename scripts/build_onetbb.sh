#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds oneTBB with a sanitizer in it: the thread sanitizer takes what a library does to keep threads apart for a fault
# of its caller where it cannot see inside.
#
#   scripts/build_onetbb.sh SANITIZER FOLDER     SANITIZER as for -fsanitize=; FOLDER/lib/cmake/TBB is then TBB_DIR
#
# Nothing is done when FOLDER holds it. (scripts/build_wheels.py builds the static one of the wheels, from the same source.)
set -euo pipefail
scripts=$(cd "$(dirname "$0")" && pwd)
sanitizer=$1 folder=$(mkdir -p "$2" && cd "$2" && pwd)

version=2021.8.0
sha256=7e9111b8bb59c8800bf6d0b06afe7b0891937443d2dae1ee1101c8e2ede6a7ef

built="$version $sanitizer $(sha256sum <"$0")"
[ "$(cat "$folder/.built" 2>/dev/null)" != "$built" ] || exit 0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quietly() { "$@" >"$work/log" 2>&1 || { tail -n 50 "$work/log" >&2; exit 1; }; }

quietly "$scripts/debian_fetch.sh" source onetbb "$work/fetched" bookworm
archive=$work/fetched/onetbb_$version.orig.tar.xz
echo "$sha256  $archive" | sha256sum --check --quiet
mkdir "$work/source"
tar -xf "$archive" -C "$work/source" --strip-components=1
quietly cmake -S "$work/source" -B "$work/build" -G Ninja -Wno-dev -DCMAKE_POLICY_VERSION_MINIMUM=3.5 \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="-fsanitize=$sanitizer -fno-omit-frame-pointer -g1" \
  -DCMAKE_INSTALL_PREFIX="$folder" -DCMAKE_INSTALL_LIBDIR=lib -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF \
  -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON
quietly cmake --build "$work/build"
quietly cmake --install "$work/build"
echo "$built" >"$folder/.built"
