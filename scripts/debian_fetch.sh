#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Downloads a package of Debian or Ubuntu into a folder, from the machine's own package servers but without touching
# its package lists or what is installed. apt checks signatures.
#
#   debian_fetch.sh source PACKAGE FOLDER [SUITE]    the source archives
#   debian_fetch.sh deb    PACKAGE FOLDER [SUITE]    the binary package
#   debian_fetch.sh closure "PACKAGE ..." FOLDER     binary packages with all they depend on
#
# SUITE names a release, such as sid, where the machine's own does not have the package.
set -euo pipefail
kind=$1 package=$2 folder=$(mkdir -p "$3" && realpath "$3") suite=${4:-}
state=$folder/.apt-${suite:-own}
mkdir -p "$state/parts" "$state/lists/partial"

# Both formats of source lists, the system's own servers only, with source packages switched on.
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
  [ -f "$list" ] || continue
  to=$state/parts/$(basename "$list")
  case $list in
    *.sources) awk 'BEGIN{RS="";ORS="\n\n"} /URIs:[^\n]*\/(debian|ubuntu)\/?[ \n]/ && !/security/' "$list" |
      sed -e 's/^Types:.*/Types: deb deb-src/' ${suite:+-e "s/^Suites:.*/Suites: $suite/"} >"$to" ;;
    *.list|*/sources.list) grep -E '^deb .*/(debian|ubuntu)/? ' "$list" | grep -v security |
      sed -E -e "s/^deb ((\[[^]]*\] )?\S+) (\S+)/deb \1 ${suite:-\3}/" -e 'p' -e 's/^deb /deb-src /' >"$to" || true ;;
  esac
done
apt=(apt-get -qq -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$state/parts" -o "Dir::State::Lists=$state/lists"
  -o Dir::State::Status=/dev/null -o Acquire::Check-Valid-Until=false -o APT::Sandbox::User=root)
"${apt[@]}" update
cd "$folder"
case $kind in
  source) "${apt[@]}" source --download-only "$package" ;;
  deb) "${apt[@]}" download "$package" ;;
  closure)
    # Nothing is installed, as far as apt can see, so that it fetches everything.
    touch "$state/status"; mkdir -p "$state/archives/partial"
    "${apt[@]}" -o "Dir::State::Status=$state/status" -o "Dir::Cache::Archives=$state/archives" \
      -o APT::Install-Recommends=false install --yes --download-only $package >/dev/null
    mv "$state"/archives/*.deb . ;;
  *) echo "debian_fetch.sh: '$kind' is none of source, deb, closure" >&2; exit 2 ;;
esac
rm -rf "$state"
