#!/bin/sh
# docs/ci/gate in a repository of its own, whose ./sasbench notes how it is called: each job has a folder
# for its base and leaves those of others alone; a base that is none is refused.
# Usage: ci_gate.sh SOURCE_ROOT. Prints what is wrong; exit status 1 then.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "$*"; exit 1; }

mkdir -p "$folder/repository/docs/ci" "$folder/temporary/sasbench-base-$(id -u)"
echo kept > "$folder/temporary/sasbench-base-$(id -u)/another job's"
cp "$1/docs/ci/gate" "$folder/repository/docs/ci/"
cd "$folder/repository"
cat > sasbench <<'EOF'
#!/bin/sh
echo "$PWD: $*" >> "$NOTES"
case "$*" in compare*) for word; do case $word in *.md) echo "$1" > "$word" ;; esac; done ;; esac
[ "$*" != "${FAULT-none}" ]
EOF
chmod +x sasbench
git init -q -b main .
git add .
git -c user.name=a -c user.email=a@b -c commit.gpgsign=false commit -q -m a
git branch other
export TMPDIR="$folder/temporary" NOTES="$folder/notes" GIT_CONFIG_GLOBAL=/dev/null
unset GITHUB_STEP_SUMMARY

docs/ci/gate other > "$folder/out" 2>&1 || fail "a good change fails: $(cat "$folder/out")"
[ "$(cat "$TMPDIR/sasbench-base-$(id -u)/another job's")" = kept ] || fail "another job's folder is gone"
grep -q "^$TMPDIR/sasbench-base-......: list" "$NOTES" || fail "the base is not built in a folder of its own: $(cat "$NOTES")"
[ "$(ls "$TMPDIR" | wc -l)" = 1 ] && [ "$(git worktree list | wc -l)" = 1 ] || fail "left behind: $(ls "$TMPDIR")"
! FAULT=test docs/ci/gate other > /dev/null 2>&1 || fail "a failing test passes"
[ "$(ls "$TMPDIR" | wc -l)" = 1 ] || fail "left behind after a failure: $(ls "$TMPDIR")"

for base in nowhere --all ''; do
    status=0
    docs/ci/gate "$base" > "$folder/out" 2>&1 || status=$?
    [ "$status" = 2 ] && grep -q "'$base' .*accepted: a branch, tag or commit" "$folder/out" && [ "$(wc -l < "$folder/out")" = 1 ] ||
        fail "BASE '$base': exit status $status, $(cat "$folder/out")"
done
