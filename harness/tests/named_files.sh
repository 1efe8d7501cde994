#!/bin/sh
# Every source file and folder that the documentation names is there. Usage: named_files.sh SOURCE_ROOT. A name is text
# between backquotes that is nothing but a path: of the source's root, of algorithms/ or harness/, or, as beside a path
# that was named before, the end of one. Prints each that is missing; exit status 1 if there is one.
set -eu
cd "$1"
{
    find . -type f -o -type l | grep -v '^./build' | sed 's,^[.]/,file ,'
    find . -mindepth 1 -type d | grep -v '^./build' | sed 's,^[.]/,file ,; s,$,/,'
    grep -rno --include='*.md' --exclude=CHANGELOG.md --exclude-dir='build*' \
        -e '`[a-z0-9_./-]*[.]\(c\|h\|sh\|gp\|awk\|build\)`' \
        -e '`\(algorithms\|harness\|plots\|scenes\|docs\|[.]ci\)/[a-z0-9_./-]*`' . | sed 's,`,,g; s,:, ,; s,:, ,'
} | awk '
    $1 == "file" {
        there[$2]
        while (sub("^[^/]*/", "", $2) && $2 != "")
            there[$2]
        next
    }
    { named++ }
    !($3 in there) {
        sub("^[.]/", "", $1)
        printf "%s:%d: %s is not there\n", $1, $2, $3
        faults++
    }
    END {
        if (named < 100) {
            printf "only %d files are named: is this the source?\n", named
            faults++
        }
        printf "%d names of files, %d not there\n", named, faults
        exit faults > 0
    }'
