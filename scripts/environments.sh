#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Creates one Python environment for each interpreter that a supported Blender exists for, with that Blender as the
# module bpy. The newest is .venv; the others carry the Blender version in their name. Where the system has no such
# interpreter the newest is downloaded into build/python, through uv.
#
#   environments.sh list     print their folders
#   environments.sh create   create what is missing, then install what pyproject.toml asks for
set -euo pipefail
cd "$(dirname "$0")/.."

# Python version and the Blender that is built for it, newest first.
supported=("3.13 5.2" "3.11 4.5")

interpreter() {  # the first interpreter of version $1 that really runs and can make environments
  local candidate
  for candidate in "python$1" build/python/cpython-"$1".*/bin/"python$1" "$(command -v pyenv >/dev/null && ls -d "$(pyenv root)"/versions/"$1".*/bin/python 2>/dev/null | tail -n 1)"; do
    [ -n "$candidate" ] || continue
    if "$candidate" -c "import sys, venv, ensurepip; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null; then
      echo "$candidate"
      return 0
    fi
  done
  return 1
}

look() {  # fills found: folder, Blender and interpreter of each environment
  local pair python blender command folder
  found=()
  for pair in "${supported[@]}"; do
    read -r python blender <<<"$pair"
    if command=$(interpreter "$python"); then
      folder=.venv
      [ ${#found[@]} -eq 0 ] || folder=.venv-$blender
      found+=("$folder $blender $command")
    fi
  done
}

fetch() {  # the newest interpreter
  local newest=${supported[0]%% *}
  mkdir -p build
  scripts/step.sh python "Python $newest comes into build/python (30 MB): this system has none that a Blender exists for" \
    bash -c "set -e
      [ -x build/uv/bin/uv ] || { python3 -m venv build/uv; build/uv/bin/python -m pip install --quiet uv; }
      UV_PYTHON_INSTALL_DIR=build/python build/uv/bin/uv python install --no-bin $newest" >&2 && return
  local packages="python$newest python$newest-venv python$newest-dev"
  echo "It could not be downloaded. Please run this, and make again:" >&2
  if [ "$(. /etc/os-release; echo "${ID:-}")" = ubuntu ]; then
    echo "  sudo add-apt-repository -y ppa:deadsnakes/ppa && sudo apt-get install -y $packages" >&2
  elif command -v pyenv >/dev/null; then
    echo "  pyenv install $newest" >&2
  else
    echo "  sudo apt-get install -y $packages     # Debian 13; on Debian 12 the same with python3.11" >&2
  fi
  exit 1
}

look
if [ ${#found[@]} -eq 0 ] && [ "${1:-list}" = create ]; then
  fetch
  look
fi
if [ ${#found[@]} -eq 0 ]; then
  echo "No Python 3.13 or 3.11 was found: run make." >&2
  exit 1
fi

wanted=$(sha256sum pyproject.toml scripts/environments.sh | sha256sum)

install() {  # $1 folder, $2 Blender, $3 interpreter; what Python compiles it compiles when it is first imported
  local folder=$1 blender=$2 command=$3
  [ -x "$folder/bin/python" ] || "$command" -m venv "$folder"
  "$folder/bin/python" - "$folder" <<'PYTHON'
import pathlib, sys, tomllib
project = tomllib.load(open("pyproject.toml", "rb"))
extras = project["project"]["optional-dependencies"]
folder = pathlib.Path(sys.argv[1])
needed = project["build-system"]["requires"] + project["project"]["dependencies"] + extras["test"]
(folder / "requirements.txt").write_text("\n".join([*needed, "fsspec", "packaging"]))
(folder / "requirements-blender.txt").write_text("\n".join(extras["blender"]))
PYTHON
  scripts/step.sh "environment$folder" \
    "installing Blender $blender and the Python packages into $folder: 900 MB, a few minutes the first time" \
    "$folder/bin/python" -m pip install --no-compile "bpy==$blender.*" ninja -r "$folder/requirements.txt"
  # Without a look at what they ask for: pyfive wants a newer NumPy than that of Blender 4.5, and works with it.
  "$folder/bin/python" -m pip install --quiet --no-compile --no-deps -r "$folder/requirements-blender.txt"
  echo "$wanted" >"$folder/.stormfield"
}

if [ "${1:-list}" = create ]; then
  jobs=() failed=false
  for entry in "${found[@]}"; do
    read -r folder blender command <<<"$entry"
    [ "$(cat "$folder/.stormfield" 2>/dev/null)" = "$wanted" ] && continue
    (install "$folder" "$blender" "$command") >&2 & jobs+=($!)
  done
  for job in "${jobs[@]}"; do wait "$job" || failed=true; done
  $failed && exit 1
fi
for entry in "${found[@]}"; do echo "${entry%% *}"; done
