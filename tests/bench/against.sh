#!/usr/bin/env bash
# tests/bench/against.sh OLD NEW [ROUNDS]: two builds of marotte (build/release/marotte of two
# worktrees), in turn, so that a busy machine is busy for both. Prints the least of ROUNDS (5) runs of
# each and NEW / OLD: a frame of the puppet and its memory, from a sample to the face published, and
# from the start of the window, hidden, to its end two drawn frames later.
set -u
[ $# -ge 2 ] || { sed -n 2,5p "$0"; exit 2; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_CONFIG_HOME=$scratch/config XDG_DATA_HOME=$scratch/data
echo "wait 2" >"$scratch/script.txt"
hand=log:$(dirname "${BASH_SOURCE[0]}")/../../plugins/log/demo_hand.csv

of_json() { sed -nE "s/^ *\"$1\": ([0-9.]+),?$/\1/p"; }
measure() { # PROGRAM -> "NAME VALUE" lines
    "$1" perform --face puppet --input "$hand" --map one_hand --json 2>/dev/null >"$scratch/perform.json"
    echo "frame_p50_ms $(of_json frame_median_ms <"$scratch/perform.json")"
    echo "frame_worst_ms $(of_json frame_worst_ms <"$scratch/perform.json")"
    echo "peak_memory_mib $(of_json peak_memory_mib <"$scratch/perform.json")"
    "$1" bench --quick --only stage 2>/dev/null | awk '/^sample to face/ { print "face_p50_ms", $5; print "face_p99_ms", $8 }'
    local before after
    before=$(date +%s%N)
    "$1" --hidden --face puppet --settings "" --script "$scratch/script.txt" >/dev/null 2>&1 || return
    after=$(date +%s%N)
    echo "window_ms $(((after - before) / 1000000))"
}

echo "load before: $(cut -d' ' -f1-3 /proc/loadavg)"
for ((i = 0; i < ${3:-5}; ++i)); do
    measure "$1" | sed 's/^/old /'
    measure "$2" | sed 's/^/new /'
done | awk '
    NF == 3 { if (!(($1, $2) in least) || $3 + 0 < least[$1, $2]) least[$1, $2] = $3 + 0; is_named[$2] = 1 }
    END {
        for (name in is_named) {
            old = least["old", name]; new = least["new", name]
            ratio = old > 0 ? new / old : 0
            printf "%-18s old %10.3f  new %10.3f  ratio %.2f\n", name, old, new, ratio
        }
    }' | sort
echo "load after: $(cut -d' ' -f1-3 /proc/loadavg)"
