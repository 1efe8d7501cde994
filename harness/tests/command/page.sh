#!/bin/bash
# The commands of a page, in its order, as one shell in an empty folder would run them: a block `sh` succeeds, or, where a
# block `text` follows at once, prints that; `...` in it stands for any text or, alone on a line, any lines. Usage:
# page.sh PROGRAM SOURCE_ROOT PAGE [LEFT_OUT], the last a pattern (grep -E) of commands that are not run. What the page has
# in /tmp is in a folder of its own. Prints what differs; exit status 1 if anything does, 77 without python3
# or the numpy that the page's commands need.
set -euo pipefail
command -v python3 >/dev/null || { echo "skipped: there is no python3"; exit 77; }
program=$(readlink -f "$1") root=$2 page=$2/$3 left_out=${4-^$}
! grep -q 'python3 ' "$page" || python3 -c 'import numpy' 2>/dev/null || { echo "skipped: python3 has no numpy"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/clone" "$folder/home" "$folder/tmp"
for name in algorithms docs scenes; do
    ln -s "$root/$name" "$folder/clone"
done
ln -s "$program" "$folder/clone/sasbench"
printf 'cd %q\n' "$folder/clone" >"$folder/session"

# Files 01.sh, 01.text, ...: the blocks.
awk -v folder="$folder" '
    /^```/ && file { close(file); file = ""; after = NR; next }
    file { print >file; next }
    $0 == "```sh" { file = sprintf("%s/%02d.sh", folder, ++blocks); printf "" >file; kind = "sh"; next }
    $0 == "```text" && kind == "sh" && NR == after + 2 {
        file = sprintf("%s/%02d.text", folder, blocks); kind = "text"; next
    }
    /^```/ { file = "/dev/null"; kind = "" }' "$page"

# run BLOCK: with the folder and the variables that those before it left.
run()
{
    # shellcheck disable=SC2016
    HOME=$folder/home bash -ec '. "$0/session"
        trap '\''{ printf "cd %q\n" "$PWD"; export -p; } >"$0/session"'\'' EXIT
        . "$1"' "$folder" "$1"
}

blocks=0 compared=0
for block in "$folder"/*.sh; do
    blocks=$((blocks + 1)) status=0
    sed -i "s|/tmp/|$folder/tmp/|g" "$block"
    grep -vE "$left_out" "$block" >"$block.run" || :
    run "$block.run" >"$folder/printed" 2>&1 </dev/null || status=$?
    if [ ! -e "${block%.sh}.text" ]; then
        [ "$status" -eq 0 ] || { cat "$block" "$folder/printed"; echo "page: exit status $status"; exit 1; }
        continue
    fi
    compared=$((compared + 1))
    python3 - "${block%.sh}.text" "$folder/printed" <<'END' || { cat "$block" "$folder/printed"; exit 1; }
import re, sys
shown, printed = (open(name).read() for name in sys.argv[1:])
pattern = ''.join('(.*\n)*' if line == '...\n' else '.*'.join(map(re.escape, line.split('...')))
                  for line in shown.splitlines(True))
if not re.fullmatch(pattern, printed):
    sys.exit(f'page: the page shows:\n{shown}but this printed, below the commands:')
END
done
[ "$blocks" -gt 0 ] || { echo "page: $page has no commands"; exit 1; }
[ "$compared" -gt 0 ] || ! grep -q '^```text$' "$page" || { echo "page: nothing that $page shows could be compared"; exit 1; }
echo "$blocks blocks, $compared compared with what the page shows"
