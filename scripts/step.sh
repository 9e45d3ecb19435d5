#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# One long step of a build: says what it does and how long that takes, keeps what it prints in build/NAME.log, and shows
# the end of that where it fails.
#
#   step.sh [--live] NAME "sentence" COMMAND...
#
# --live: on a terminal what the command prints is shown instead, as Ninja does in one line.
set -uo pipefail
live=false
if [ "$1" = --live ]; then
  shift
  [ -t 1 ] && live=true
fi
name=$1 sentence=$2
shift 2
log=$(dirname "$0")/../build/$name.log
mkdir -p "$(dirname "$log")"

echo "$sentence"
began=$SECONDS status=0
if $live; then
  "$@" || status=$?
else
  "$@" >"$log" 2>&1 </dev/null || status=$?
fi
if [ $status -eq 0 ]; then
  [ $((SECONDS - began)) -lt 5 ] || echo "  done in $((SECONDS - began)) s"
  exit 0
fi
if ! $live; then
  tail -n 40 "$log" >&2
  echo "The whole log is build/$name.log" >&2
fi
echo "failed: $sentence" >&2
exit $status
