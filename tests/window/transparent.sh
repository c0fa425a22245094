#!/usr/bin/env bash
# The output window over something else, with a compositor: around the face what lies below is seen, and the face covers it.
source "$(dirname "$0")/xvfb.sh"
for program in picom ffplay ffmpeg; do
    command -v "$program" >/dev/null || { echo "SKIPPED: $program is not installed (packages picom, ffmpeg)"; exit 77; }
done
others=()
trap '[ -z "$program_pid" ] || kill -9 "$program_pid" 2>/dev/null; kill "${others[@]}" 2>/dev/null; rm -rf "$scratch"' EXIT
below="48 96 192" # a plain colour over the whole screen
ffplay -v error -noborder -left 0 -top 0 -f lavfi color=c=0x3060c0:s=1280x720:r=5 >/dev/null 2>&1 &
others+=($!)
picom --backend xrender --config /dev/null >picom.txt 2>&1 &
others+=($!)
pixel_is_below() { # X Y of shot.rgb: within what a film's colours lose
    od -An -tu1 -j $((3 * ($2 * 1280 + $1))) -N3 shot.rgb |
        awk -v b="$below" '{ split(b, c); for (i = 1; i <= 3; ++i) if ($i - c[i] > 6 || c[i] - $i > 6) exit 1 }'
}
shoot() { ffmpeg -nostdin -v error -y -f x11grab -draw_mouse 0 -video_size 1280x720 -i "$DISPLAY" -frames:v 1 -pix_fmt rgb24 -f "$2" "$1"; }
looks_below() { shoot shot.rgb rawvideo && pixel_is_below "$1" "$2"; }
until_true looks_below 480 270 || { echo "SKIPPED: nothing can be shown below here: $(tail -n 1 picom.txt)"; exit 77; }

echo '{"looks": {}, "picture": {"background": "transparent", "window": 1}}' >window.json
printf 'frames 3\ndo output\nwait 600\n' >script.txt
open_window s.marotte --face "$puppet" --map one_hand --settings window.json --size 640x360 --script script.txt
until_true xdotool search --onlyvisible --name 'marotte: output' || { fail "no output opens: $(cat stderr.txt)"; finish; }
output=$(xdotool search --onlyvisible --name 'marotte: output' | tail -n 1)
for window in $(windows); do [ "$window" = "$output" ] || xdotool windowmove "$window" 1200 680; done
xdotool windowmove "$output" 0 0
eval "$(xdotool getwindowgeometry --shell "$output" | grep -E '^(WIDTH|HEIGHT)=')"
is_transparent() { # its corners let through what its middle covers
    looks_below 8 8 && pixel_is_below $((WIDTH - 8)) 8 && pixel_is_below 8 $((HEIGHT - 8)) &&
        ! pixel_is_below $((WIDTH / 2)) $((HEIGHT / 2))
}
until_true is_transparent || fail "what lies below is not seen around the face"
mkdir -p "$BUILD_DIR/out" && shoot "$BUILD_DIR/out/transparent.png" image2
kill "$program_pid"
until_true is_gone || kill -9 "$program_pid"
program_pid=
finish
