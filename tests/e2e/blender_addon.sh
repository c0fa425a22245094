#!/usr/bin/env bash
# The Blender add-on: a take as a strip and as an action on a head that is there already, the take edited, live faces.
# What is shown is at ten times at most 0.5 mm and 0.1 % of the height off the point cache.
source "$(dirname "$0")/lib.sh"
command -v blender >/dev/null || { echo "SKIPPED: Blender is not installed"; exit 77; }

try() { # name face mapping
    local folder=$scratch/$1 show=$scratch/$1/show.marotte
    mkdir "$folder"
    "$MAROTTE" perform --face "$2" --input "log:$demo,end=5" --map "$3" --record "$show" >"$scratch/told" 2>&1 &&
        "$MAROTTE" take export "$show" last --fps 24 --export "$folder/first.glb" --export "$folder/first.pc2" >"$scratch/told" 2>&1 &&
        "$MAROTTE" take export "$show" last --fps 24 --bare --export "$folder/bare.glb" >"$scratch/told" 2>&1 &&
        "$MAROTTE" take trim "$show" last --in 1 --out 3.5 >"$scratch/told" 2>&1 &&
        "$MAROTTE" take export "$show" last --fps 24 --export "$folder/second.glb" --export "$folder/second.pc2" >"$scratch/told" 2>&1 ||
        { fail "$1: $(tail -n 2 "$scratch/told")"; return; }
    blender -b --factory-startup -noaudio --python-exit-code 1 -P "$SOURCE_DIR/tests/e2e/blender_addon.py" -- \
        "$folder" 24 >"$scratch/said" 2>&1 || { fail "$1: $(tail -n 5 "$scratch/said")"; return; }
    local lines
    lines=$(grep -E '^(strip|updated|action|live): ' "$scratch/said")
    echo "$1, $3: $(tr '\n' ';' <<<"$lines")"
    [ "$(wc -l <<<"$lines")" -eq 4 ] || fail "$1: not all was tried: $lines"
    awk '/off by/ { n += $4 > 0.26 || $(NF - 1) < 5 } END { exit n }' <<<"$lines" ||
        fail "$1: $lines"
}
try moai "${moai%.glb}.rig.json" anchored
[ -z "${MAROTTE_TEST_LONG:-}" ] || try clay "$moai" unanchored
try puppet "$puppet" one_hand
finish
