#!/usr/bin/env bash
# The pictures of the panels' pages, docs/pictures/panels/NAME.png, from Blender's window. Run under a screen of 1600x1000
# (xvfb-run) with ImageMagick:
#   scripts/docs_pictures.sh [NAME...]       names as in docs_pictures.py
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- field elements solve solved bake shading look drawing analysis curves morse
mkdir -p out/pictures docs/pictures/panels
for name in "$@"; do
  STORMFIELD_PICTURE=$name STORMFIELD_OUT=out/pictures \
    timeout 180 blender --factory-startup --gpu-backend opengl -P scripts/docs_pictures.py >"out/pictures/$name.log" 2>&1
  convert "out/pictures/$name.png" -crop "$(cat "out/pictures/$name.crop")" +repage "out/pictures/$name.cut.png"
  # The empty lower end of a sidebar has one colour.
  case $name in
    solved | drawing | analysis | morse) fit=(-resize 1000x) ;;
    *) fit=(-fuzz 1% -define trim:edges=south -trim +repage) ;;
  esac
  convert "out/pictures/$name.cut.png" "${fit[@]}" -dither None -colors 160 "docs/pictures/panels/$name.png"
done
