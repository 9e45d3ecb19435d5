#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Creates one Python environment for each interpreter that a supported Blender exists for, with that Blender as the
# module bpy, and prints their folders. The newest is .venv; the others carry the Blender version in their name.
#
#   environments.sh list     print the folders
#   environments.sh create   create what is missing, then install what pyproject.toml asks for
set -euo pipefail
cd "$(dirname "$0")/.."

# Python version and the Blender that is built for it, newest first.
supported=("3.13 5.2" "3.11 4.5")

interpreter() {  # the first interpreter of version $1 that really runs and can make environments
  local candidate
  for candidate in "python$1" "$(command -v pyenv >/dev/null && ls -d "$(pyenv root)"/versions/"$1".*/bin/python 2>/dev/null | tail -n 1)"; do
    [ -n "$candidate" ] || continue
    if "$candidate" -c "import sys, venv, ensurepip; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null; then
      echo "$candidate"
      return 0
    fi
  done
  return 1
}

found=()
for pair in "${supported[@]}"; do
  read -r python blender <<<"$pair"
  if command=$(interpreter "$python"); then
    folder=.venv
    [ ${#found[@]} -eq 0 ] || folder=.venv-$blender
    found+=("$folder $blender $command")
  fi
done
if [ ${#found[@]} -eq 0 ]; then
  echo "No Python 3.13 or 3.11 was found; install one of them (Debian 12 has 3.11, Debian 13 has 3.13)." >&2
  exit 1
fi

for entry in "${found[@]}"; do
  read -r folder blender command <<<"$entry"
  if [ "${1:-list}" = create ]; then
    stamp=$folder/.stormfield
    wanted=$(sha256sum pyproject.toml scripts/environments.sh | sha256sum)
    if [ "$(cat "$stamp" 2>/dev/null)" != "$wanted" ]; then
      echo "environment $folder: Blender $blender" >&2
      [ -x "$folder/bin/python" ] || "$command" -m venv "$folder"
      "$folder/bin/python" - <<'PYTHON' >"$folder/requirements.txt"
import tomllib
project = tomllib.load(open("pyproject.toml", "rb"))
print("\n".join(project["build-system"]["requires"] + project["project"]["dependencies"]
                + project["project"]["optional-dependencies"]["test"]))
PYTHON
      "$folder/bin/python" -m pip install --quiet "bpy==$blender.*" ninja -r "$folder/requirements.txt" >&2
      echo "$wanted" >"$stamp"
    fi
  fi
  echo "$folder"
done
