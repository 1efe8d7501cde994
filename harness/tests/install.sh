#!/bin/bash
# What `meson install` installs works without the source folder, may be moved, and goes away whole.
#   install.sh BUILD SOURCE
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

die() { echo "install: $*" >&2; exit 1; }

DESTDIR=$folder/first meson install -C "$build" --no-rebuild --quiet >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
[ -z "$(find "$folder/first" -type f -path "*$source*")" ] || die "a file lies where the source folder is"
bin=$(dirname "$(find "$folder/first" -name sasbench -type f -perm -u+x)")
mv "${bin%/bin}" "$folder/moved"
prefix=$folder/moved
export PATH=$prefix/bin:$PATH XDG_CACHE_HOME=$folder/cache
mkdir "$folder/work"
cd "$folder/work"

# A run of an own scene among the installed ones; results go below the current folder.
sed 's/^/ /' "$prefix/share/sasbench/scenes/study/quick.cfg" >"$prefix/share/sasbench/scenes/study/installed.cfg"
sasbench run study/installed -a bp_nearest >out 2>err || die "run: $(cat out err)"
grep -q "Next: .*sasbench report results/latest" out || die "run ends with: $(tail -n 1 out)"
! grep -q '\./sasbench' out || die "an installed program is not called ./sasbench"
sasbench run study/installed -a bp_nearest -o "of 'ours" >out 2>&1 && grep -qF "sasbench report 'of '\\''ours'" out ||
    die "the next command cannot be taken: $(tail -n 1 out)"
[ -s results/latest/measurements.csv ] && [ -s results/latest/study_installed-bp_nearest.png ] || die "results/latest lacks files"
sasbench report results/latest >/dev/null && [ -s results/latest/report.html ] || die "no report"
! sasbench reproduce --docs >out 2>&1 || die "reproduce --docs has no folder to write into"
! sasbench --help | grep -q '^  test ' || die "'test' is the script's"

# The program sets OpenMP's waiting, and keeps its name.
env -u OMP_WAIT_POLICY sasbench conformance bp_sinc >/dev/null 2>&1 &
for ((k = 0; k < 100; k++)); do
    sleep 0.05
    ! grep -qz '^OMP_WAIT_POLICY=passive$' "/proc/$!/environ" || break
done
[ "$k" -lt 100 ] || die "OMP_WAIT_POLICY is not set"
[ "$(cat "/proc/$!/comm")" = sasbench ] || die "the process is called $(cat "/proc/$!/comm")"
kill $!
wait $! 2>/dev/null || :

# Every command has its section, with an example, as roff takes it.
manual=$prefix/share/man/man1/sasbench.1
commands=$(sasbench complete '' | grep -v '^-\|^help$')
for command in $commands; do
    grep -qx "\.SS $command" "$manual" || die "$command is not in the manual"
done
[ "$(grep -c '^Example:' "$manual")" -eq "$(wc -w <<<"$commands")" ] || die "commands without an example"
if command -v groff >/dev/null; then
    [ -z "$(groff -man -Tutf8 -ww -z "$manual" 2>&1)" ] || die "$(groff -man -Tutf8 -ww -z "$manual" 2>&1)"
fi

# Shells: the last word of a line, completed.
# shellcheck source=/dev/null
. "$prefix/share/bash-completion/completions/sasbench"
compopt() { :; }
completes()
{
    COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=()
    _sasbench
    [[ " ${COMPREPLY[*]} " == *" $2 "* ]] || die "'$1' is completed by: ${COMPREPLY[*]}"
}
completes 'sasbench ru' run
completes 'sasbench help pl' plan
completes 'sasbench run ' study/quick
completes 'sasbench run study/ins' study/installed
completes 'sasbench run --al' --algorithm
completes 'sasbench run -a bp_li' bp_linear
completes 'sasbench run --algorithm bp_linear:' beta=
completes 'sasbench run --algorithm bp_linear:beta=' 16
completes 'sasbench run -a bp_linear:beta=16,pre' 16,preemphasis=
completes 'sasbench run -a bp_linear:beta=16,preemphasis=o' on
completes 'sasbench image -a bp_sinc:precision=d' double
completes 'sasbench reproduce bp22_t' bp22_t1
completes 'sasbench reproduce lbf21-5B-1' lbf21-5B-1
completes 'sasbench info rma_' rma_delay
completes 'sasbench sweep --precision ' float
for shell in zsh fish; do
    ! command -v "$shell" >/dev/null || "$shell" -n "$(find "$prefix/share/$shell" -name '*sasbench*' -type f)" ||
        die "$shell does not take its completion"
done

# The header serves plug-ins.
cc -std=gnu17 -shared -fPIC -I"$prefix/include" -o mine.so "$prefix/share/doc/sasbench/plugin/mine.c" -lm
sasbench info ./mine.so >/dev/null || die "a plug-in by the installed header is refused"
[ -n "$(find "$prefix" -name sasbench.pc)" ] || die "no sasbench.pc"

# MATLAB and Octave find the program beside their functions.
[ -s "$prefix/share/sasbench/matlab/+sasbench/image.m" ] || die "no functions for MATLAB"
if command -v octave-cli >/dev/null && ! PATH=/usr/bin:/bin command -v sasbench >/dev/null; then
    found=$(PATH=/usr/bin:/bin octave-cli -qf --eval "warning('off', 'Octave:shadowed-function');
        addpath('$prefix/share/sasbench/matlab'); disp(sasbench.program())" 2>err) || die "octave: $(cat err)"
    [ "$found" = "$prefix/bin/sasbench" ] || die "octave finds the program at: $found"
fi

# The library serves other programs, with the scenes that were moved with it.
cat >use.c <<'END'
#include <libsasbench.h>
#include <stdio.h>
int main(void)
{
    struct sasbench *context;
    struct sasbench_scene *scene;
    const int status = sasbench_open(1, NULL, &context);
    if (status != SAS_OK || sasbench_scene_load(context, "study/installed", &scene) != SAS_OK)
        return puts(sasbench_message()), 1;
    printf("%d pings\n", sasbench_scene_arrays(scene)->acquisition->pings);
    sasbench_scene_free(scene);
    sasbench_close(context);
    return 0;
}
END
library=$(find "$prefix" -name libsasbench.so)
cc -std=c11 -Wall -Wextra -Wpedantic -Werror -I"$prefix/include" -o use use.c "$library"
# A sanitizer would have to be in the other program itself.
nm -D "$library" | grep -E ' U __(asan|tsan|ubsan)' >/dev/null || [ "$(LD_LIBRARY_PATH=$(dirname "$library") ./use)" = "18 pings" ] ||
    die "libsasbench finds no scene"
grep -q -- "-lsasbench" "$(find "$prefix" -name libsasbench.pc)" || die "no libsasbench.pc"
[ -z "$(nm -D --defined-only "$library" | grep -v ' T sasbench_')" ] || die "libsasbench shows more than its functions"

# A copy that is removed leaves nothing.
DESTDIR=$folder/second meson install -C "$build" --no-rebuild --quiet >/dev/null 2>&1
[ -n "$(find "$folder/second" -type f)" ] || die "nothing is installed the second time"
DESTDIR=$folder/second ninja -C "$build" uninstall >/dev/null 2>&1
[ ! -e "$folder/second" ] || [ -z "$(find "$folder/second" ! -type d)" ] || die "left: $(find "$folder/second" ! -type d)"
