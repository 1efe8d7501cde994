#!/bin/bash
# The wheel, built of a copy without optimisation, as only its contents count; then installed where nothing else is.
#   wheel.sh SOURCE PYTHON
set -euo pipefail
source=$1 python=$2
"$python" -c 'import mesonpy, numpy, pip, venv' 2>/dev/null ||
    { echo "skipped: python3-mesonpy, python3-numpy, python3-pip or python3-venv is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset PYTHONPATH SASBENCH_LIBRARY

die() { echo "wheel: $*" >&2; exit 1; }

mkdir "$folder/source" "$folder/a b"
cp -r "$source"/{algorithms,harness,python,scenes} "$source"/{meson.build,meson_options.txt,pyproject.toml,README.md,LICENSE} \
    "$folder/source"
cd "$folder"
"$python" -m pip wheel ./source --no-build-isolation --no-deps --wheel-dir wheels \
    --config-settings setup-args=-Doptimization=0 >log 2>&1 || { cat log; exit 1; }
case $(ls wheels) in
    *-py3-none-any.whl) die "the wheel has code of a machine: $(ls wheels)" ;;
    sasbench-*-linux_*.whl) ;;
    *) die "wheels: $(ls wheels)" ;;
esac
"$python" -m zipfile -l wheels/*.whl >files
for name in sasbench/__init__.py sasbench/libsasbench.so sasbench/py.typed sasbench/scenes/study/quick.cfg; do
    grep -q "^$name " files || die "$name is not in the wheel"
done
! grep -q '/bin/\|\.h \|/include/\|test_' files || die "the wheel has more than the package: $(cat files)"
"$python" -m venv --system-site-packages "a b/own"
"a b/own/bin/python" -m pip install --no-deps --no-index wheels/*.whl >log 2>&1 || { cat log; exit 1; }
rm -r source wheels
cd "a b"
own/bin/python - <<'END' || die "the installed package fails"
import sasbench
scene = sasbench.scene("study/quick")
assert sasbench.score(scene, sasbench.image(scene, "bp_sinc"))["error"] < 0.1
assert ".so" in sasbench.native._library._name and "own" in sasbench.native._library._name
END
