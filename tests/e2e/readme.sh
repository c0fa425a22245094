#!/usr/bin/env bash
# Every command that the README and the guides to takes, exports and outputs show works as shown, from the top folder. Except in
# ./test --long, pictures and videos are smaller and recordings shorter. The stage runs for a second without a window. (./test is
# what runs this.)
source "$(dirname "$0")/lib.sh"
cd "$SOURCE_DIR" || exit 1
count=0
if [ -z "${MAROTTE_TEST_LONG:-}" ]; then # ./run itself, with the first seconds of its recordings
    sed -E 's#^here=.*#here=$SOURCE_DIR#; s#(demo_hand|demo_left_hand)\.csv#&,end=2#g; s#log:demo( |$)#log:demo,end=2\1#g; s#\.png"#& --size 640x320#; s#640x360#160x90#' \
        run >"$scratch/run"
    [ "$(grep -c 'end=2' "$scratch/run")" -eq 3 ] || fail "run performs other recordings"
fi
while read -r line; do
    case $line in
    "" | "#"* | ./test*) continue ;;
    "./run bench --quick" | "./run paper --quick") continue ;; # bench/gate and e2e/paper run these
    "./run stage"*) line="$line --hidden --seconds 1" ;;
    blender*) command -v blender >/dev/null || { echo "SKIPPED: Blender is not installed: $line"; continue; } ;;
    esac
    if [ -z "${MAROTTE_TEST_LONG:-}" ]; then
        line=$(sed -E 's/--size [0-9]+x[0-9]+/--size 160x90/; /--size/! s/^\.\/run .*\.png.*/& --size 640x320/
            s/log:demo( |$)/log:demo,end=5.2\1/; s/rig check .*puppet.*/rig check moai/; s/--poses/& --only joy,jawOpen/
            s/--frames 1-50/--frames 1-10/; s/--frames 51-100/--frames 11-20/; s#^\./run$#bash "$scratch/run"#' <<<"$line")
    fi
    count=$((count + 1))
    echo "\$ $line"
    scratch=$scratch bash -c "$line" >"$scratch/log" 2>&1 || { fail "$line"; tail -n 5 "$scratch/log"; }
done < <(awk '/^```sh$/ { on = 1; next } /^```/ { on = 0 } on' README.md ui/takes.md ui/exports.md ui/outputs.md)
[ $count -ge 20 ] || fail "only $count commands were found in the guides"
finish
