#!/usr/bin/env bash
# ui/blender/gltf_to_fbx.py: the FBX, imported again, shows what was performed, and hands as .bvh stand where they stood.
source "$(dirname "$0")/lib.sh"
command -v blender >/dev/null || { echo "SKIPPED: Blender is not installed"; exit 77; }
blender_run() { # SCRIPT ARGS...
    local script=$1
    shift
    blender -b --factory-startup -noaudio --python-exit-code 1 -P "$SOURCE_DIR/$script" -- "$@" >"$scratch/said" 2>&1
}

convert() { # name face mapping
    "$MAROTTE" perform --face "$2" --input "log:$demo,end=4" --map "$3" --fps 25 --export "$scratch/$1.glb" \
        --export "$scratch/$1.pc2" --export "$scratch/$1.bvh" >/dev/null 2>"$scratch/stderr" &&
        "$MAROTTE" perform --face "$2" --input "log:$demo,end=4" --map "$3" --fps 25 --bare \
            --export "$scratch/$1.bare.glb" >/dev/null 2>"$scratch/stderr" ||
        { fail "$1: $(cat "$scratch/stderr")"; return; }
    blender_run ui/blender/gltf_to_fbx.py "$scratch/$1.glb" "$scratch/$1.fbx" ||
        { fail "$1: $(tail -n 4 "$scratch/said")"; return; }
    grep -q "^wrote $scratch/$1.fbx: .* frames 0 to 100 at 25 a second" "$scratch/said" ||
        fail "$1: $(tail -n 4 "$scratch/said")"
    blender_run tests/e2e/blender_fbx.py "$scratch/$1.fbx" "$scratch/$1.bare.glb" "$scratch/$1.pc2" 25 ||
        { fail "$1: $(tail -n 4 "$scratch/said")"; return; }
    echo "$1, $3: $(grep -E '^(imported|off by)' "$scratch/said" | tr '\n' ';')"
    awk '/^off by/ { n = $3 <= 0.26 && $(NF - 1) > 5 } END { exit !n }' "$scratch/said" ||
        fail "$1: $(grep '^off by' "$scratch/said")"
}
convert moai "${moai%.glb}.rig.json" anchored
[ -z "${MAROTTE_TEST_LONG:-}" ] || convert clay "$moai" unanchored
convert puppet "$puppet" one_hand

blender_run tests/e2e/blender_hands.py "$scratch/moai.bvh" || fail "$(tail -n 4 "$scratch/said")"
grep '^hands: ' "$scratch/said" || fail "nothing of the hands"

# What cannot be converted is said, and nothing is written.
for bad in "$demo" "$scratch/none.glb"; do
    ! blender_run ui/blender/gltf_to_fbx.py "$bad" "$scratch/bad.fbx" || fail "$bad was converted"
    [ ! -e "$scratch/bad.fbx" ] || fail "$bad left a file"
done
finish
