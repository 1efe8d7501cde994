#!/bin/bash
# The commands of a page, in its order, in one empty folder: a block `sh` succeeds, or, where a block `text` follows at
# once, prints that; `...` in it stands for any text or, alone on a line, any lines. Usage: page.sh PROGRAM PAGE. Prints
# what differs; exit status 1 if anything does, 77 without python3.
set -euo pipefail
command -v python3 >/dev/null || { echo "skipped: there is no python3"; exit 77; }
program=$(readlink -f "$1") page=$(readlink -f "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/clone"
cd "$folder/clone"
ln -s "$program" sasbench

# Files 01.sh, 01.text, ...: the blocks.
awk -v folder="$folder" '
    /^```/ && file { close(file); file = ""; after = NR; next }
    file { print >file; next }
    $0 == "```sh" { file = sprintf("%s/%02d.sh", folder, ++blocks); printf "" >file; kind = "sh"; next }
    $0 == "```text" && kind == "sh" && NR == after + 2 {
        file = sprintf("%s/%02d.text", folder, blocks); kind = "text"; next
    }
    /^```/ { file = "/dev/null"; kind = "" }' "$page"

blocks=0 compared=0
for block in "$folder"/*.sh; do
    blocks=$((blocks + 1)) status=0
    bash -e "$block" >"$folder/printed" 2>&1 </dev/null || status=$?
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
[ "$compared" -gt 0 ] || { echo "page: $page shows nothing that could be compared"; exit 1; }
echo "$blocks blocks, $compared compared with what the page shows"
