#!/usr/bin/env bash
# video.sh [OTHER_MAROTTE]: what a frame of video costs in processor time, by size, and what 19.9 s of it
# at 640x360 take, by the clock and in processor time; beside another build of marotte in turn, so that
# a busy machine is busy for both, with the ratio and whether the decoded frames are equal. Not a test:
# it prints.
set -e
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
marotte=${MAROTTE:-$source_dir/build/release/marotte} other=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$marotte" perform --face puppet --input "log:$source_dir/plugins/log/demo_hand.csv" --map one_hand \
    --record s.marotte >/dev/null 2>&1
TIMEFORMAT='%R %U %S'
export_video() { # program size from to file: seconds by the clock, and of processors with what it starts
    { time "$1" take export s.marotte last --in "$3" --out "$4" --size "$2" --export "$5" >/dev/null 2>log; } 2>&1 |
        awk '{ print $1, $2 + $3 }'
    [ -s "$5" ] || { cat log >&2; return 1; }
}
frame() { # program size: ms a frame, without what is done once
    local short long
    short=$(export_video "$1" "$2" 1 1.1 v.mp4) long=$(export_video "$1" "$2" 1 4.1 v.mp4)
    echo "$short $long" | awk '{ printf "%.1f", ($4 - $2) / 90 * 1000 }'
}
best() { # of lines "clock processor": the least of each
    awk 'NR == 1 || $1 < a { a = $1 } NR == 1 || $2 < b { b = $2 } END { printf "%.1f %.1f", a, b }' "$1"
}
frames() { # file: a hash of what is decoded
    ffmpeg -v error -i "$1" -map 0:v -f framemd5 - | md5sum
}

for round in 1 2 3; do
    export_video "$marotte" 640x360 0 19.9 ours.mp4 >>ours
    [ -z "$other" ] || export_video "$other" 640x360 0 19.9 theirs.mp4 >>theirs
done
read -r clock cpu <<<"$(best ours)"
echo "19.9 s, 640x360: $clock s by the clock, $cpu s of processors: the best of 3"
if [ -n "$other" ]; then
    read -r their_clock their_cpu <<<"$(best theirs)"
    awk -v a="$clock" -v b="$cpu" -v c="$their_clock" -v d="$their_cpu" 'BEGIN {
        printf "  by the other %.1f and %.1f s: %.2f and %.2f of its time\n", c, d, a / c, b / d }'
    [ "$(frames ours.mp4)" = "$(frames theirs.mp4)" ] && echo "  the same frames" || echo "  OTHER FRAMES"
fi
for size in 160x90 320x240 640x360 1280x720; do
    ours=$(frame "$marotte" $size)
    printf '%-9s %6.1f ms a frame' $size "$ours"
    if [ -n "$other" ]; then
        theirs=$(frame "$other" $size)
        awk -v a="$theirs" -v b="$ours" 'BEGIN { printf ", %.1f ms by the other: %.2f times as fast", a, a / b }'
    fi
    echo
done
