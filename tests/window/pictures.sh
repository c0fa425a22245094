#!/usr/bin/env bash
# pictures.sh [FOLDER]: writes the film and pictures of the real window that the guides show to .github/ (or FOLDER): the puppet
# speaking, a live performance, the timeline, a painted rig, the card of the hand, the steps from a head to a video. Recorded hands perform, on a private X server. Not a test: look at
# the results, then commit them.
#   ninja -C build/release marotte-program && MAROTTE=build/release/marotte tests/window/pictures.sh
# pictures.sh --panels FOLDER: writes each panel and each layout at 800x500, 1280x720, 1920x1080 and 4K at 200 %, without a display:
# FOLDER/SIZE_PANEL.png, and with ImageMagick a sheet of each size. Look at all of them after a change of the panels.
here=$(cd "$(dirname "$0")/../.." && pwd)
export SOURCE_DIR=$here
MAROTTE=$(realpath "${MAROTTE:-$here/build/release/marotte}")

panels() { # FOLDER
    local face=$here/rigs/puppet/puppet.rig.json hand=$here/plugins/log/demo_hand.csv size width height scale panel show
    mkdir -p "$1" || exit 1
    for size in 800x500@1 1280x720@1 1920x1080@1 1920x1080@2; do
        IFS=x@ read -r width height scale <<<"$size"
        show=$(mktemp -d)
        {
            echo 'frames 5'
            for panel in devices mapping patch rig engine log output scene hand poses; do
                printf 'do panel_%s\nframes 3\npicture %s/%s_%s.png\n' $panel "$1" "$size" $panel
            done
            for panel in edit rig; do
                printf 'do layout_%s\nframes 3\npicture %s/%s_layout_%s.png\n' $panel "$1" "$size" $panel
            done
            printf 'do layout_perform\ndo panel_mapping\ndo panel_float\nframes 3\npicture %s/%s_floating.png\n' "$1" "$size"
        } >"$show/script"
        "$MAROTTE" stage "$show/night.marotte" --hidden --size "${width}x$height" --scale "$scale" --face "$face" --map one_hand \
            --input "log:$hand" --script "$show/script" >/dev/null || exit 1
        rm -r "$show"
        ! command -v montage >/dev/null || montage "$1/${size}"_*.png -tile 3x -geometry 900x+6+6 "$1/sheet_$size.png"
    done
}
if [ "${1:-}" = --panels ]; then
    panels "$(realpath -m "${2:?the folder of the pictures}")"
    exit
fi

folder=$(realpath "${1:-$here/.github}")
export MAROTTE MAROTTE_SCREEN=1440x810x24
source "$(dirname "$0")/xvfb.sh" "$folder"
command -v ffmpeg >/dev/null || { echo "SKIPPED: ffmpeg is not installed"; exit 77; }

# The demo hand up to a moment, which it then holds: so the picture is sharp on any machine.
held() { # SECONDS FILE
    awk -F, -v OFS=, -v stop="$1" '
        /^#/ || !/^[0-9]/ || $1 <= stop { print; if (/^[0-9]/) last = $0; next }
        END { n = split(last, v, ","); for (t = stop + 0.01; t < stop + 120; t += 0.01) { v[1] = sprintf("%.3f", t); line = v[1]; for (i = 2; i <= n; ++i) line = line OFS v[i]; print line } }' \
        "$demo" >"$2"
}
work() { # words of marotte
    "$MAROTTE" "$@" >/dev/null 2>stderr.txt || { fail "$*: $(cat stderr.txt)"; finish; }
}
# window PICTURE ARGUMENTS...: the script comes in; when it is done, what is on the screen is kept.
window() {
    local picture=$1
    shift
    { cat; echo "picture $scratch/now.png"; echo "wait 20"; } >script.txt
    rm -f now.png
    open_window "$@" --size 1440x810 --settings "" --script script.txt
    until_true test -s now.png || fail "the script of $picture does not end: $(cat stderr.txt)"
    sleep 0.5
    ffmpeg -v error -f x11grab -draw_mouse 0 -video_size 1440x810 -i "$DISPLAY" -frames:v 1 -quality 88 -y "$folder/$picture" </dev/null ||
        fail "$picture"
    kill -TERM "$program_pid"
    ends 0
}

# The film: the demo hand plays at an eighth of its speed, so that a slow machine draws each frame.
film_fps=12 film_s=6 film_slowness=8
{
    echo 'do show_card'
    echo 'do face_only'
    echo "picture $scratch/now.png"
    echo "wait $((film_s * film_slowness + 60))"
} >script.txt
rm -f now.png
open_window film.marotte --face "$puppet" --map one_hand --input log:demo,speed=0.125 --size 1440x810 --settings "" --script script.txt
until_true test -s now.png || fail "the film does not begin: $(cat stderr.txt)"
xdotool mousemove 1439 809 # its circle is not on the face
ffmpeg -v error -f x11grab -draw_mouse 0 -framerate "$film_fps/$film_slowness" -video_size 1440x810 -i "$DISPLAY" \
    -frames:v $((film_fps * film_s)) -vf "setpts=PTS/$film_slowness,fps=$film_fps,scale=720:-2:flags=lanczos" -c:v libwebp_anim -quality 60 \
    -compression_level 6 -loop 0 -y "$folder/speaks.webp" </dev/null || fail speaks.webp
kill -TERM "$program_pid"
ends 0

held 6.27 hand.csv
window stage_live.png live.marotte --face "$puppet" --map one_hand,smile_gain=120 --input log:hand.csv <<END
do panel_mapping
do view_three_quarter
do record
wait 14
END

window one_hand_card.png card.marotte --face "$puppet" --map one_hand --input log:hand.csv <<END
do show_card
do face_only
wait 8
END

# Three takes of a scene: the third with a voice, a second layer, marks.
for shot in a a; do
    work perform --face "$puppet" --input "log:$demo,end=9" --map one_hand --record night.marotte --scene 2 --shot $shot
done
work perform --face "$puppet" --input "log:$demo" --map one_hand,smile_gain=120 --record night.marotte --scene 2 --shot b
work take rate night.marotte 1 2
work take rate night.marotte 3 5
work take timecode night.marotte 3 --fps 25 --start 10:21:00:00
work take record night.marotte 3 --input "log:$demo,start=9,end=17" --map one_hand,smile_gain=150 --own brows --name brows --in 4 --out 12
work take mark night.marotte 3 'looks up' --at 2.2
work take mark night.marotte 3 'big laugh' --at 6.2
work take mark night.marotte 3 'sigh' --at 13.3
# A voice: syllables of a hum.
ffmpeg -v error -f lavfi -i "aevalsrc='0.5*sin(2*PI*(140+20*sin(t*2.1))*t)*(0.5+0.5*sin(t*23))*(gt(sin(t*1.7),-0.3))*(0.4+0.6*abs(sin(t*3.1)))':s=16000:d=19" \
    -y voice.wav </dev/null
work take audio attach night.marotte 3 voice.wav --offset 0.4
{
    echo 'do panel_devices'
    echo 'drag 700 590 700 470 20'
    echo 'do take_before'
    echo 'wait 2'
    echo 'do take_before'
    echo 'wait 2'
    for _ in $(seq 17); do echo 'do second_forward'; done
    echo 'move 700 300'
    echo 'wait 10'
} | window stage_timeline.png night.marotte --face "$puppet" --map one_hand --input log:hand.csv

cp -r "$SOURCE_DIR/rigs/puppet" puppet # it is painted
window stage_rig.png rig.marotte --face "$scratch/puppet/puppet.rig.json" --map one_hand <<END
do panel_rig
do timeline
wait 1
press Paint
wait 8
move 672 415
down
move 684 425
frames 2
move 696 440
frames 2
move 704 458
frames 2
up
wait 6
move 700 452
wait 6
END

# From your head to a video (ui/guide/head_to_video.md): the Moai's mesh is a head without a rig, then with a drafted one.
cp "$SOURCE_DIR/rigs/moai/moai.glb" head.glb
window guide_draft.webp draft.marotte --face head.glb <<END
wait 4
move 700 300
wait 2
END
work rig new head.glb
window guide_rig.webp rig_drafted.marotte --face head.rig.json <<END
do panel_rig
do timeline
wait 6
END
window guide_perform.webp perform.marotte --face head.rig.json --map one_hand,jaw_gain=150 --input log:hand.csv <<END
do show_card
do panel_mapping
wait 12
END
work perform --face head.rig.json --input "log:$demo,end=9" --map one_hand --record cut.marotte
work take audio attach cut.marotte last voice.wav
work take trim cut.marotte last --in 1 --out 6
{
    echo 'do take_before'
    echo 'wait 3'
    for _ in 1 2 3; do echo 'do second_forward'; done
    echo 'wait 4'
} >cut_script
window guide_cut.webp cut.marotte --face head.rig.json <cut_script
{
    cat cut_script
    echo 'do export'
    echo 'wait 3'
} | window guide_export.webp cut.marotte --face head.rig.json
finish
