#!/usr/bin/env bash
# open_show.sh OTHER - opening a good show with this tree and with OTHER, another checkout with a build in
# build/release: in turn, so that a busy machine is busy for both. Prints both times and their ratio.
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
other=${1:?say which other checkout}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp "$here/tests/take/golden/four_takes.marotte" "$scratch/show.marotte"
build() { # tree program
    cc -O2 -std=c11 -D_DEFAULT_SOURCE -D_POSIX_C_SOURCE=200809L -I"$1/core" -I"$1/core/include" \
        "$here/tests/bench/open_show.c" "$1/build/release/core/show/libmarotte_take.a" \
        "$1/build/release/core/base/libmarotte_base.a" -lsqlite3 -lz -lnettle -ljansson -lm -lpthread -o "$2"
}
build "$here" "$scratch/ours"
build "$other" "$scratch/theirs"
for round in 1 2 3 4 5 6 7 8; do
    "$scratch/ours" "$scratch/show.marotte" 200 >>"$scratch/ours.us"
    "$scratch/theirs" "$scratch/show.marotte" 200 >>"$scratch/theirs.us"
done
least() { sort -n "$1" | head -n 1; }
awk -v ours="$(least "$scratch/ours.us")" -v theirs="$(least "$scratch/theirs.us")" \
    'BEGIN { printf "opening a show: %.0f us, with the other build %.0f us: a ratio of %.2f\n", ours, theirs, ours / theirs }'
