# What the end-to-end scripts share. Sourced. Works in a scratch folder of its own.
# shellcheck shell=bash
set -u
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_CONFIG_HOME=$scratch/config # no calibrations of whoever runs the tests
export XDG_DATA_HOME=$scratch/data # and no reports to them
export TEST_TMPDIR=/nowhere # here the thread sanitizer makes a file when a program starts, and crashes under `ulimit -f`
shared=${MAROTTE_SHARED:-$SOURCE_DIR/../shared}
moai=$SOURCE_DIR/rigs/moai/moai.glb
puppet=$SOURCE_DIR/rigs/puppet/puppet.rig.json
demo=$SOURCE_DIR/plugins/log/demo_hand.csv
demo_left=$SOURCE_DIR/plugins/log/demo_left_hand.csv
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# refused CODE WORDS COMMAND...: the command ends with CODE, says one line on stderr that contains
# WORDS, and leaves nothing in $scratch/out. Notes, and what a plugin says itself, do not count.
refused() {
    local code=$1 words=$2 got lines
    shift 2
    rm -rf "$scratch/out"
    mkdir "$scratch/out"
    timeout 60 "$@" >"$scratch/stdout" 2>"$scratch/stderr"
    got=$?
    lines=$(grep -cvE '^(note: |(warning|error): org\.)' "$scratch/stderr")
    [ "$got" -eq "$code" ] || fail "exit $got instead of $code: $* ($(tail -c 300 "$scratch/stderr"))"
    [ "$lines" -eq 1 ] || fail "$lines lines on stderr instead of 1: $* ($(cat "$scratch/stderr"))"
    grep -qF -- "$words" "$scratch/stderr" || fail "\"$words\" is not said: $(cat "$scratch/stderr")"
    [ -z "$(ls -A "$scratch/out")" ] || fail "left behind by $*: $(ls -A "$scratch/out")"
}

# fact NAME FILE: the number behind a label of perform's output.
fact() {
    sed -nE "s/^$1 +([-0-9.]+).*/\1/p" "$2" | head -n 1
}

finish() {
    [ "$failures" -eq 0 ] && exit 0
    echo "$failures failures"
    exit 1
}
