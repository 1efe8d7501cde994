#!/bin/sh
# `report --site`: kinds of machine apart, the newest row of a cell, texts of strangers, folders and rows that are refused.
# Usage: results_site.sh PROGRAM
set -eu
program=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "results_site: $*" >&2; exit 1; }

"$program" run study/quick -a bp_nearest -a bp_sinc -t 1 -o new >/dev/null
# edited DIR SED: a copy of the results.
edited() { mkdir "$1"; sed "$2" new/measurements.csv >"$1/measurements.csv"; }
edited old 's/^# date: .*/# date: 2001-02-03T04:05:06Z/; s/^# commit: .*/# commit: 0123456789ab/'
edited other 's|^# machine: .*|# machine: <script>x</script> \& "y", 3 cores|'

"$program" report --site new old other -o out >told
[ "$(cat told)" = out/index.html ] || fail "printed '$(cat told)'"
[ "$(ls out | tr '\n' ' ')" = 'index.html scene-1.html ' ] || fail "out has $(ls out)"
! grep -q '<script>x' out/*.html || fail 'a machine became a script'
grep -q '&lt;script&gt;x&lt;/script&gt; &amp; &quot;y&quot;, 3 cores' out/index.html || fail 'a machine is not there'

# sections FILE: each on a line.
sections() { tr '\n' ' ' <"$1" | sed 's/<section>/\n&/g; s|</section>|&\n|g' | grep '^<section>'; }
[ "$(sections out/index.html | wc -l)" = 2 ] || fail 'two kinds of machine have no two rankings'
sections out/scene-1.html | grep 'Over commits' >same || fail 'there is no history'
[ "$(wc -l <same)" = 1 ] || fail 'a history of two machines'
! grep -q 'script' same || fail 'the history is of the machine with one folder'
[ "$(grep -o '>0123456789ab<' same | wc -l)" = 2 ] || fail 'the older commit is not in the history of two settings'
! grep -q 'old/measurements.csv' same || fail 'an older row is among the newest'
for page in out/*.html; do
    size=$(sed -n '/<script>/,/<\/script>/p' "$page" | wc -c)
    [ "$size" -gt 0 ] && [ "$size" -le 10240 ] || fail "$page has $size bytes of script"
done
if command -v xmllint >/dev/null; then
    for page in out/*.html; do sed '/<script>/,/<\/script>/d; 1d' "$page" | xmllint --noout - || fail "$page is not strict"; done
fi

# A failed row in the newest folder does not hide an older one that was measured.
edited broken 's/^\(study.quick,bp_nearest,[^,]*,[^,]*,[^,]*,[^,]*\),ok,/\1,failed,/; s/^# date: .*/# date: 2099-01-01T00:00:00Z/'
grep -q ',failed,' broken/measurements.csv || fail 'no row failed'
"$program" report --site new broken -o mended >/dev/null
sections mended/scene-1.html | grep -q '>bp_nearest<' || fail 'a failed row hides a measured one'

# An older site is replaced; another folder is not touched.
touch out/scene-7.html
"$program" report --site old -o out >/dev/null
[ ! -e out/scene-7.html ] || fail 'a page of the older site is left'
! grep -q '3 cores' out/index.html || fail 'the older site is left'

# refused TEXT ARGUMENTS: exit status 2, and a message that has the text.
refused()
{
    text=$1
    shift
    status=0
    "$program" report "$@" >told 2>&1 || status=$?
    [ $status = 2 ] || fail "report $*: exit status $status"
    grep -q -- "$text" told || fail "report $*: $(cat told)"
}
mkdir theirs
echo kept >theirs/notes.txt
refused 'theirs/notes.txt is no page of a results site' --site new -o theirs
[ "$(cat theirs/notes.txt)" = kept ] && [ ! -e theirs/index.html ] || fail 'a folder of others was written into'
ln -s theirs link
mkdir page
echo '<title>mine</title>' >page/index.html
refused 'page/index.html is no page of a results site' --site new -o page
grep -q mine page/index.html || fail 'a page of others was replaced'
refused 'notes.txt' --site new -o link
refused '-o OUT is missing' --site new
refused 'goes with --site' new -o out
refused 'nowhere/measurements.csv' --site new nowhere -o out
edited headless '/^# machine:/d'
refused "headless/measurements.csv: the line '# machine: ...' is missing" --site new headless -o out
mkdir faulty # quoted fields have commas
sed 's/"[^"]*"/quoted/g' new/measurements.csv |
    awk -F, -v OFS=, '/^scene,/ { for (k = 1; k <= NF; k++) at[$k] = k } /bp_nearest/ { $at["run_min_s"] = 7 } { print }' \
        >faulty/measurements.csv
refused 'faulty/measurements.csv:[0-9]*: run_min_s of study/quick by bp_nearest is 7; at most run_s' --site new faulty -o out
edited undated 's/^# date: .*/# date: zzzz/'
refused "the date is 'zzzz'" --site undated -o out
edited changed 's/^# scene study.quick: .*/# scene study\/quick: 0123456789abcdef/'
refused 'one content is accepted for a name' --site new changed -o out
edited single 's/^# threads: .*/# threads: 0/'
refused 'of study/quick has 1 threads, the head 0' --site single -o out
mkdir double
{ cat new/measurements.csv; grep '^study/quick,bp_nearest' new/measurements.csv; } >double/measurements.csv
refused 'double/measurements.csv has a row of study/quick by bp_nearest of the same date' --site double -o out
refused 'of the same date; one is accepted' --site new new -o out
edited long "s/^# machine: .*/# machine: $(printf '%0200d' 7)/"
refused "'# machine: ...' has 200 characters" --site long -o out
grep -q '0123456789ab' out/index.html || fail 'a refusal changed the site'
