#!/usr/bin/env bash
# `marotte plugin check`: names the one rule that each broken plugin breaks, and there is a broken
# plugin for every rule; finds nothing in a sound one; refuses what it cannot do.
source "$(dirname "$0")/lib.sh"
broken=$BUILD_DIR/tests/plugin
sound=$broken/sound.so
seed=${MAROTTE_CHECK_SEED:-1}

# The plugins that are named by a short word, as other tests have them.
declare -A short=([library.symbol]=symbol [library.abi]=abi [life.create]=create [mapping.count]=many
    [mapping.finite]=nan [param.range]=param [mapping.radius]=radius [mapping.reach]=reach
    [mapping.result]=result)

# ---- every rule has a plugin that breaks it, and it alone is named ----
rules=$("$MAROTTE" plugin check --rules | awk '{ print $1 }')
[ "$(wc -w <<<"$rules")" -gt 70 ] || fail "only these rules: $rules"
for rule in $rules; do
    library=$broken/${short[$rule]:-${rule/./_}}.so
    [ -e "$library" ] || { fail "no plugin breaks $rule: $library"; continue; }
    said=$scratch/$(basename "$library" .so).said
    "$MAROTTE" plugin check "$library" --seed "$seed" >"$said"
    got=$?
    named=$(awk '$2 == "FAILED" { print $1 }' "$said" | tr '\n' ' ')
    [ "$named" = "$rule " ] || { fail "$rule: names $named"; cat "$said"; }
    [ $got -eq 1 ] || fail "$rule: exit $got"
    grep -A1 " FAILED " "$said" | grep -q "plugin.h: " || fail "$rule: no word of plugin.h"
done

# ---- what it did is named with its place ----
explains() { # PLUGIN WORDS
    grep -qE "FAILED +$2" "$scratch/$1.said" || fail "$1: does not say $2"
}
"$MAROTTE" plugin check "$broken/state_allocation.so" --seed "$seed" >"$scratch/state_allocation.said"
"$MAROTTE" plugin check "$broken/poses_written.so" --seed "$seed" >"$scratch/poses_written.said"
explains frame_allocation 'process\(\) called malloc\(\) in .*\(frame_allocation.so\+0x'
explains state_allocation 'save\(\) called malloc\(\) in .*\(state_allocation.so\+0x'
explains poses_written '.*: it wrote to the poses of the rig'
explains rig_poses_set '(Segmentation fault|Aborted) in set_poses.*, in set\(\) with 0 poses'
explains rig_poses_valid '(Segmentation fault|Aborted) in process.*, with 2 poses after 0 others'
explains run_crash '(Segmentation fault|Aborted) in .*\(run_crash.so\+0x.*in a random walk'
explains nan 'frame 3 of a random walk: the end of vector 0 is \(nan, '

# ---- a sound one ----
env -u MAROTTE_CHECK_DIVISOR "$MAROTTE" plugin check "$sound" --seed "$seed" >"$scratch/said" || { fail "sound.so"; cat "$scratch/said"; }
grep -q '^0 failed, [89][0-9] ok, 0 skipped; .* seed '"$seed"'$' "$scratch/said" || fail "$(tail -1 "$scratch/said")"
"$MAROTTE" plugin check "$sound" --repeat 2 --seed 5 >"$scratch/said" || fail "--repeat"
[ "$(grep -c 'nothing found; .* seed [56]$' "$scratch/said")" -eq 2 ] || fail "--repeat: $(cat "$scratch/said")"

# ---- for machines ----
"$MAROTTE" plugin check "$broken/nan.so" --json --seed 1 >"$scratch/json"
[ $? -eq 1 ] || fail "--json: the exit code"
if command -v python3 >/dev/null; then
    python3 - "$scratch/json" <<'PYTHON' || fail "--json"
import json, sys
report = json.load(open(sys.argv[1]))
failed = [r["rule"] for t in report["types"] for r in t["rules"] if r["verdict"] == "failed"]
assert failed == ["mapping.finite"], failed
assert report["failed"] == 1 and report["seed"] == 1, report
assert report["types"][0]["id"] == "org.example.broken"
assert all(r["says"] for r in report["library"]["rules"])
PYTHON
fi

# ---- what is no plugin ----
mkfifo "$scratch/pipe.so"
head -c 3000 /dev/urandom >"$scratch/random.so"
head -c 9000 "$sound" >"$scratch/cut.so"
for file in "$scratch/none.so" "$scratch/pipe.so" "$scratch/random.so" "$scratch/cut.so" "$scratch"; do
    named=$("$MAROTTE" plugin check "$file" | awk '$2 == "FAILED" { print $1 }' | tr '\n' ' ')
    [ "$named" = "library.load " ] || fail "$file: names $named"
done

# ---- what it is not told ----
usage() {
    "$MAROTTE" plugin check "$@" >/dev/null 2>"$scratch/stderr"
    [ $? -eq 2 ] || fail "check $*: no usage error"
    [ -s "$scratch/stderr" ] || fail "check $*: says nothing"
}
usage
usage "$sound" "$sound"
usage "$sound" --seed
usage "$sound" --seed -1
usage "$sound" --repeat 0
usage "$sound" --waldo 1
MAROTTE_PLUGINCHECK=$scratch/none "$MAROTTE" plugin check "$sound" >/dev/null 2>"$scratch/stderr" &&
    fail "a program that is not there"
grep -q MAROTTE_PLUGINCHECK "$scratch/stderr" || fail "does not name MAROTTE_PLUGINCHECK"
finish
