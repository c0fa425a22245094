#!/usr/bin/env bash
# video.sh [OTHER_MAROTTE]: what a frame of video costs in processor time, by size; beside another build
# of marotte in turn, so that a busy machine is busy for both, with the ratio. Not a test: it prints.
set -e
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
marotte=${MAROTTE:-$source_dir/build/release/marotte} other=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$marotte" perform --face puppet --input "log:$source_dir/plugins/log/demo_hand.csv" --map one_hand \
    --record s.marotte >/dev/null 2>&1
TIMEFORMAT='%U %S'
cpu() { # program size seconds: processor seconds of it and of what it starts
    { time "$1" take export s.marotte last --in 1 --out "$3" --size "$2" --export v.mp4 >/dev/null 2>&1; } 2>&1 |
        awk '{ print $1 + $2 }'
}
frame() { # program size: ms a frame, without what is done once
    local short long
    short=$(cpu "$1" "$2" 1.1) long=$(cpu "$1" "$2" 4.1)
    awk -v a="$short" -v b="$long" 'BEGIN { printf "%.1f", (b - a) / 90 * 1000 }'
}
for size in 160x90 320x240 640x360 1280x720; do
    ours=$(frame "$marotte" $size)
    printf '%-9s %6.1f ms a frame' $size "$ours"
    if [ -n "$other" ]; then
        theirs=$(frame "$other" $size)
        awk -v a="$theirs" -v b="$ours" 'BEGIN { printf ", %.1f ms by the other: %.2f times as fast", a, a / b }'
    fi
    echo
done
