#!/usr/bin/env bash
# The main job: the demo recording performs the puppet with one hand, and two hands the Moai through both
# mappings of the paper; every export is there, complete and not empty. The first 4 s of the recordings: ./run, which
# e2e/readme runs, plays the whole of them.
source "$(dirname "$0")/lib.sh"
for map in one_hand anchored unanchored; do
    face=${moai%.glb}.rig.json
    hands=(--input "log:$demo,end=4" --input "log:$demo_left,end=4")
    [ $map = one_hand ] && face=$puppet hands=(--input "log:$demo,end=4")
    facts=$scratch/$map.txt
    exports=()
    for kind in glb pc2 mdd csv png; do exports+=(--export "$scratch/$map.$kind"); done
    "$MAROTTE" perform --verbose --face "$face" "${hands[@]}" --map $map --size 640x320 "${exports[@]}" >"$facts" ||
        fail "perform $map"
    echo "--- $map"
    cat "$facts"
    [ "$(fact 'samples read' "$facts")" -ge 390 ] || fail "$map: too few samples"
    [ "$(fact frames "$facts")" -ge 119 ] || fail "$map: too few frames"
    [ "$(fact folds "$facts")" -eq 0 ] || fail "$map: the face folds"
    awk -v mm="$(fact 'range of motion' "$facts")" 'BEGIN { exit !(mm > 5 && mm < 120) }' ||
        fail "$map: the face moves $(fact 'range of motion' "$facts") mm"
    for kind in glb pc2 mdd csv png; do
        [ "$(stat -c %s "$scratch/$map.$kind")" -gt 1000 ] || fail "$map.$kind is missing or tiny"
    done
    # Twice the same: the same bytes.
    "$MAROTTE" perform --face "$face" "${hands[@]}" --map $map \
        --export "$scratch/again.glb" --export "$scratch/again.pc2" >/dev/null || fail "again $map"
    cmp "$scratch/$map.glb" "$scratch/again.glb" || fail "$map.glb differs from run to run"
    cmp "$scratch/$map.pc2" "$scratch/again.pc2" || fail "$map.pc2 differs from run to run"
done
# The other ways to read the hand fold nothing either.
for mode in mask layered_waldo; do
    "$MAROTTE" perform --verbose --face "$puppet" --input "log:$demo,end=8" --map "one_hand,mode=$mode" \
        >"$scratch/mode.txt" || fail "perform one_hand $mode"
    [ "$(fact folds "$scratch/mode.txt")" -eq 0 ] || fail "one_hand $mode: the face folds"
done
# A neutral hand is the rest face, exactly.
{ grep -m1 '^time' "$demo"; for i in $(seq 0 99); do
    grep -m1 '^0' "$demo" | sed -E "s/^[^,]+/$(printf '0.%02d' "$i")/"; done; } >"$scratch/still.csv"
"$MAROTTE" perform --verbose --face "$puppet" --input "log:$scratch/still.csv" --map one_hand \
    >"$scratch/still.txt" || fail "a still hand"
[ "$(fact 'range of motion' "$scratch/still.txt")" = 0.00 ] || {
    fail "a still hand moves the face"
    cat "$scratch/still.txt"
}
# As JSON, and with the frame rate and length asked for.
"$MAROTTE" perform --face "$moai" --input "log:$demo,speed=2" --map anchored --fps 60 --seconds 2 \
    --json >"$scratch/facts.json" || fail "perform --json"
grep -q '"frames": 120' "$scratch/facts.json" || fail "2 s at 60 a second are not 120 frames"
# A performance in real time takes its time and loses nothing.
"$MAROTTE" perform --verbose --face "$moai" --input "log:$demo,end=1" --map anchored --realtime \
    >"$scratch/real.txt" || fail "perform --realtime"
[ "$(fact 'samples read' "$scratch/real.txt")" -ge 99 ] || fail "real time lost samples"
"$MAROTTE" perform --help | grep -q -- --export || fail "perform --help"
"$MAROTTE" deform --help >/dev/null || fail "deform --help"
"$MAROTTE" plugin list --params | grep -q org.marotte.anchored || fail "plugin list"
# A mapping that another one replaced is in no list, and performs.
"$MAROTTE" plugin list | grep -q org.marotte.poses && fail "plugin list shows a mapping that was replaced"
"$MAROTTE" perform --face "$puppet" --input "log:$demo,end=1" --map poses >"$scratch/poses.txt" || fail "perform --map poses"
"$MAROTTE" plugin list --json >"$scratch/plugins.json" || fail "plugin list --json"
finish
