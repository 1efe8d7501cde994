#!/bin/sh
# The pages as a site: a copy of the source, so that links lead to the same files as in a clone, with the pages that the
# program writes itself (docs/pages.py). Sphinx makes the site of it.
# usage: site.sh SOURCE_ROOT PROGRAM FOLDER    writes FOLDER/source and FOLDER/site; exit status 77 without Sphinx
set -eu
source=$1 program=$2 folder=$3 python=
for try in python3 /usr/bin/python3; do
    ! "$try" -c 'import furo, myst_parser, sphinx' 2>/dev/null || python=$try
done
if [ -z "$python" ]; then
    echo "skipped: there is no Sphinx, furo or MyST (Debian packages python3-sphinx, furo, python3-myst-parser)"
    exit 77
fi
rm -rf "$folder/source" "$folder/site"
mkdir -p "$folder/source"
(cd "$source" && tar -cf - CHANGELOG.md CONTRIBUTING.md CITATION.cff LICENSE README.md algorithms debian docs harness \
    matlab meson.build meson_options.txt plots pyproject.toml python results scenes .ci .github codemeta.json sasbench) |
    tar -xf - -C "$folder/source"
PYTHONDONTWRITEBYTECODE=1
export PYTHONDONTWRITEBYTECODE
"$python" "$folder/source/docs/pages.py" "$folder/source" "$program"
"$python" -m sphinx -q -n -W -b html -d "$folder/doctrees" -c "$folder/source/docs" "$folder/source" "$folder/site"
