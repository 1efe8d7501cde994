#!/bin/sh
# The script ./sasbench with a meson and a ninja that only say what they were asked: what it builds, tells and counts.
# Usage: front_door.sh SOURCE_ROOT. Prints what is not as expected; exit status 1 if anything is.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin" "$folder/root"
cp "$1/sasbench" "$folder/root"
cat >"$folder/bin/meson" <<'END'
#!/bin/sh
case $1 in
    setup) mkdir -p "$2/harness" "$2/meson-logs" && printf '#!/bin/sh\necho "the program: $*"\n' >"$2/harness/sasbench"
        chmod +x "$2/harness/sasbench" ;;
    test) cp "${0%/bin/*}/log" "$3/meson-logs/testlog.json"; echo "$*" >"${0%/bin/*}/asked"
        echo "1/3 a   OK   0.01s"; echo "2/3 numbers - sasbench:c FAIL 0.02s exit status 1"; echo "c: 1 is not 2"
        echo "3/3 d TIMEOUT 600.02s"; echo "2/3 numbers - sasbench:c FAIL 0.02s exit status 1"; exit 1 ;;
esac
END
cat >"$folder/bin/ninja" <<'END'
#!/bin/sh
shift 2
echo "ninja: Entering directory"
echo "[0/2] Generating harness/commit.h with a custom command"
echo "[1/2] building ${*:-all}"
echo "a warning"
[ ! -e "${0%/bin/*}/broken" ]
END
chmod +x "$folder/bin/meson" "$folder/bin/ninja"
cat >"$folder/log" <<'END'
{"name": "a", "result": "OK", "returncode": 0}
{"name": "b", "result": "EXPECTEDFAIL", "returncode": 1}
{"name": "c", "stdout": "\"result\": \"OK\"", "result": "FAIL", "returncode": 1}
{"name": "d", "result": "FAIL", "returncode": -11}
{"name": "e", "result": "TIMEOUT", "returncode": -15}
{"name": "f", "result": "SKIP", "returncode": 77}
{"name": "g", "result": "INTERRUPT", "returncode": -15}
{"name": "h", "result": "FAIL", "returncode": -9}
END

# Texts that the script says, given the arguments in $1, on both streams; each further one is a line of its own.
says()
{
    arguments=$1
    shift
    # shellcheck disable=SC2086
    (PATH="$folder/bin:$PATH" EXTRA_PACKAGES='' "$folder/root/sasbench" $arguments 2>&1 || echo "status $?") >"$folder/said"
    printf '%s\n' "$@" >"$folder/expected"
    diff "$folder/expected" "$folder/said" || { echo "front_door: ./sasbench $arguments"; failed=1; }
}

# What meson was asked for.
asks()
{
    [ "$(cat "$folder/asked")" = "$1" ] || { echo "front_door: meson was asked: $(cat "$folder/asked")"; failed=1; }
}

failed=0
building="sasbench: building in $folder/root/build (once, some minutes)"
said='c: 1 is not 2
2/3 numbers - sasbench:c FAIL 0.02s exit status 1'
says list "$building" 'the program: list'
says test "$said" '2 passed, 3 failed, 1 skipped, 2 interrupted' 'status 1'
asks "test -C $folder/root/build --no-rebuild --print-errorlogs --no-suite long"
sed -i '/INTERRUPT\|-9/d' "$folder/log"
says 'test --all' "$said" '2 passed, 3 failed, 1 skipped' 'status 1'
asks "test -C $folder/root/build --no-rebuild --print-errorlogs"
says 'test a c' "$said" '2 passed, 3 failed, 1 skipped' 'status 1'
asks "test -C $folder/root/build --no-rebuild --print-errorlogs a c"
touch "$folder/broken"
says list 'a warning' 'sasbench: the build failed' 'status 1'
rm "$folder/broken"

# A build that meson was asked for by hand is kept; that of another folder is not.
mkdir "$folder/root/build/meson-info"
for source in "$folder/root" "$folder/moved"; do
    rm "$folder/root/build/built-for"
    printf '{"directories": {"source": "%s", "build": "%s/build", "info": ""}}' "$source" "$source" \
        >"$folder/root/build/meson-info/meson-info.json"
    if [ "$source" = "$folder/root" ]; then says list 'the program: list'; else says list "$building" 'the program: list'; fi
done

# Packages that are missing: a line; what apt says only where it fails.
mkdir "$folder/apt"
printf '#!/bin/sh\n' >"$folder/apt/dpkg-query"
printf '#!/bin/sh\nexec "$@"\n' >"$folder/apt/sudo"
printf '#!/bin/sh\necho noise\n[ ! -e "%s/broken" ]\n' "$folder" >"$folder/apt/apt-get"
chmod +x "$folder/apt"/*
for noisy in 0 1; do
    [ "$noisy" = 0 ] || touch "$folder/broken"
    PATH="$folder/apt:$folder/bin:$PATH" "$folder/root/sasbench" list >"$folder/said" 2>&1 || :
    [ "$(grep -c '^sasbench: installing gcc ' "$folder/said")" = 1 ] && [ "$(grep -c noise "$folder/said")" = "$noisy" ] ||
        { echo "front_door: installing:"; cat "$folder/said"; failed=1; }
done
exit "$failed"
