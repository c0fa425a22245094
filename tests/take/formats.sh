#!/usr/bin/env bash
# A show of each format that marotte ever wrote opens, plays and can be edited, and loses nothing by it. A show of a newer format
# opens for reading alone. The shows are those of programs of their time: a new format brings one along.
source "$(dirname "$0")/../e2e/lib.sh"
command -v sqlite3 >/dev/null || { echo "SKIPPED: sqlite3 is not installed"; exit 77; }
formats=$SOURCE_DIR/tests/take/formats
now=$(sed -n 's/.*SHOW_VERSION = \([0-9]*\).*/\1/p' "$SOURCE_DIR/core/show/show_schema.h")
show=$scratch/show.marotte
cd "$SOURCE_DIR" || exit 1 # the faces of the shows are named from here

version() { sqlite3 "file:$1?immutable=1" "PRAGMA user_version"; }
samples() { # FILE: what was recorded
    "$MAROTTE" take log "$show" 1 --track 1 --out "$1" >/dev/null 2>"$scratch/stderr"
}
alone() { [ "$(cd "$scratch" && echo show.marotte*)" = show.marotte ] || fail "version $1: $2 left $(cd "$scratch" && echo show.marotte*)"; }

for ((v = 2; v <= now; ++v)); do # no program of the repository ever wrote version 1
    of=$formats/version_$v.marotte
    [ -s "$of" ] || { fail "there is no show of version $v"; continue; }
    cp "$of" "$show"
    [ "$(version "$show")" = "$v" ] || fail "$of has version $(version "$show")"
    "$MAROTTE" take list "$show" >"$scratch/stdout" || fail "version $v: take list"
    grep -q '^take 1 ' "$scratch/stdout" || fail "version $v: take 1 is not listed: $(cat "$scratch/stdout")"
    alone $v "take list"
    "$MAROTTE" take check "$show" >"$scratch/stdout" 2>&1 || fail "version $v: $(cat "$scratch/stdout")"
    samples "$scratch/before.csv" || fail "version $v: take log: $(cat "$scratch/stderr")"
    [ "$(wc -l <"$scratch/before.csv")" -gt 20 ] || fail "version $v: has no samples"
    "$MAROTTE" take export "$show" 1 --export "$scratch/out.csv" >/dev/null 2>"$scratch/stderr" ||
        fail "version $v does not play: $(cat "$scratch/stderr")"
    cmp "$of" "$show" || fail "version $v: reading changed it"
    "$MAROTTE" take rename "$show" 1 "kept since $v" >/dev/null || fail "version $v cannot be edited"
    [ "$(version "$show")" = "$now" ] || fail "version $v was not migrated"
    alone $v "take rename"
    "$MAROTTE" take list "$show" >"$scratch/stdout"
    grep -q "kept since $v" "$scratch/stdout" || fail "version $v: the new name is lost: $(cat "$scratch/stdout")"
    "$MAROTTE" take check "$show" >/dev/null || fail "version $v is damaged by migrating it"
    samples "$scratch/after.csv"
    cmp "$scratch/before.csv" "$scratch/after.csv" || fail "version $v: other samples"
done

# ---- a newer one ----
sqlite3 "$show" "ALTER TABLE take ADD COLUMN mood TEXT; PRAGMA user_version = $((now + 1))"
cp "$show" "$scratch/newer"
"$MAROTTE" take list "$show" >"$scratch/stdout" || fail "a newer show is not listed"
grep -q "kept since $now" "$scratch/stdout" || fail "a newer show is listed without its take"
if "$MAROTTE" take rename "$show" 1 other >/dev/null 2>"$scratch/stderr"; then fail "a newer show is changed"; fi
grep -q "it was made by a newer marotte (format $((now + 1)), this one writes $now): update marotte" "$scratch/stderr" ||
    fail "a newer show: $(cat "$scratch/stderr")"
[ "$(wc -l <"$scratch/stderr")" -eq 1 ] || fail "a newer show: more than a sentence: $(cat "$scratch/stderr")"
cmp "$show" "$scratch/newer" || fail "a newer show was changed"
alone "$((now + 1))" "a refused edit"
finish
