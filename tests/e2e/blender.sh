#!/usr/bin/env bash
# Blender imports what is exported, and plays it as it was performed: ten times of each face against its point
# cache. At most 0.5 mm and 0.1 % of the height off. One face of each kind: ./test --long has more.
source "$(dirname "$0")/lib.sh"
command -v blender >/dev/null || { echo "SKIPPED: Blender is not installed"; exit 77; }

play() { # name face mapping height_mm
    local most_mm=0.5
    "$MAROTTE" perform --face "$2" --input "log:$demo,end=6" --map "$3" --fps 30 \
        --export "$scratch/$1.glb" --export "$scratch/$1.pc2" >"$scratch/told" 2>"$scratch/stderr" &&
        "$MAROTTE" perform --face "$2" --input "log:$demo,end=6" --map "$3" --fps 30 --bare \
            --export "$scratch/$1.bare.glb" >/dev/null 2>"$scratch/stderr" ||
        { fail "$1: $(cat "$scratch/stderr")"; return; }
    ! grep -q '^mesh alone' "$scratch/told" || fail "$1: $(grep '^mesh alone' "$scratch/told")"
    blender -b --factory-startup -noaudio --python-exit-code 1 -P "$SOURCE_DIR/tests/e2e/blender_import.py" -- \
        "$scratch/$1.glb" "$scratch/$1.bare.glb" "$scratch/$1.pc2" 30 >"$scratch/said" 2>&1 ||
        { fail "$1: $(tail -n 5 "$scratch/said")"; return; }
    echo "$1, $3: $(grep -E '^(imported|off by)' "$scratch/said" | tr '\n' ';')"
    off=$(sed -nE 's/^off by ([0-9.]+) mm.*/\1/p' "$scratch/said")
    awk -v off="$off" -v most="$most_mm" -v height="$4" \
        'BEGIN { exit !(off != "" && (off <= most || off <= 0.001 * height)) }' ||
        fail "$1, $3: Blender shows it $off mm off"
    grep -qE ' ([1-9][0-9]*) of them found' "$scratch/said" || fail "$1: no vertex was found again"
}
play moai "${moai%.glb}.rig.json" anchored 300
[ -z "${MAROTTE_TEST_LONG:-}" ] || play moai_clay "$moai" unanchored 300
play puppet "$puppet" one_hand 260
for key in jaw.open 'mouth.corner.l out' 'remainder 1'; do
    grep -q "^keys: .*$key" "$scratch/said" || fail "puppet: Blender has no key $key"
done
if [ -e "$shared/data/faces/ict_face.glb" ]; then
    cp "$shared/data/faces/ict_face.glb" "$scratch/"
    sed 's#"mesh": "[^"]*/#"mesh": "#' "$SOURCE_DIR/tests/face/ict.rig.json" >"$scratch/ict.rig.json"
    play ict "$scratch/ict.rig.json" one_hand 340
    grep -q '^keys: .*mouthSmile_L' "$scratch/said" || fail "ict: Blender has lost its own shapes"
else
    echo "SKIPPED: ICT: no $shared/data (set MAROTTE_SHARED)"
fi
if [ -d "$shared/data/heads" ]; then
    heads=(girl.glb)
    [ -z "${MAROTTE_TEST_LONG:-}" ] || heads+=(reyn_head.glb cryptovoxels.vrm)
    for head in "${heads[@]}"; do
        cp "$shared/data/heads/$head" "$scratch/head_$head"
        play "${head%.*}" "$scratch/head_$head" unanchored 1800
        [ "$head" != girl.glb ] || grep -qE '^imported: .* [1-9][0-9]* images' "$scratch/said" ||
            fail "girl: Blender has no images"
    done
else
    echo "SKIPPED: the heads: no $shared/data (set MAROTTE_SHARED)"
fi
finish
