#!/bin/bash
# The functions of matlab/ in Octave, by matlab.m beside this file; skipped without it.
#   matlab.sh PROGRAM SOURCE
set -euo pipefail
program=$(readlink -f "$1") source=$2
if ! octave-cli --version >/dev/null 2>&1; then
    echo "skipped: there is no octave-cli (Debian package octave)"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/temporary 'files'" "$folder/work"
cd "$folder/work"
TMPDIR="$folder/temporary 'files'" octave-cli -qf "$source/harness/tests/matlab.m" "$program" "$source"
