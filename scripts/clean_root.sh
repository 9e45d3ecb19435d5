#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Unpacks a system that has Python and what Blender itself loads, and nothing else, into a folder: what the machine's
# own release would install on an empty disk. It needs no root and changes nothing outside the folder.
#
#   clean_root.sh FOLDER
set -euo pipefail
here=$(dirname "$(realpath "$0")")
folder=$(mkdir -p "$1" && realpath "$1")
stamp=$folder/.complete
[ "$(cat "$stamp" 2>/dev/null)" != "$(sha256sum "$0")" ] || exit 0
rm -rf "${folder:?}"/* "$stamp"

packages=(
  base-files bash coreutils python3
  # what Blender's manual asks of a Linux machine, and Blender as a Python module loads
  libx11-6 libxrender1 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1
)

# Debian and Ubuntu keep programs and libraries under /usr, and packages still name the old places.
mkdir -p "$folder"/usr/{bin,sbin,lib,lib64} "$folder"/{proc,dev,tmp,home}
for name in bin sbin lib lib64; do ln -s "usr/$name" "$folder/$name"; done

"$here/debian_fetch.sh" closure "${packages[*]}" "$folder/packages"
for package in "$folder"/packages/*.deb; do dpkg-deb --fsys-tarfile "$package" | tar -x -C "$folder" --keep-directory-symlink; done
rm -rf "$folder/packages"
ldconfig -r "$folder" 2>/dev/null || /sbin/ldconfig -r "$folder"
sha256sum "$0" >"$stamp"
