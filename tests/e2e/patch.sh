#!/usr/bin/env bash
# Patches: a hand and faders perform together, the take performs again bit for bit, another patch
# changes it, and whatever is wrong with a patch is said.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
show=$scratch/a.marotte

# A double of a fader box and a pad: 2 s at 125 Hz.
awk 'BEGIN {
    print "time_s,cc.0,cc.1,lefty,button.mark\nunit,0..1,0..1,-1..1,1"
    for (i = 0; i < 250; ++i)
        printf "%.3f,%.4f,%.4f,%.4f,%d\n", i * 0.008, 0.5 - 0.5 * cos(i * 0.02),
            (i > 100 ? 1 : i / 100), sin(i * 0.03), (i >= 150 && i < 170)
}' >faders.csv
patch_of() { # file connections
    printf '{"marotte_patch": 1, "name": "test", "connections": [%s]}\n' "$2" >"$1"
}
jaw='{"from": {"channel": "cc.0"}, "to": {"dof": "jaw.open"}, "smooth_s": 0.05}'
brows='{"from": {"input": "log", "channel": "cc.1"}, "to": {"contact": "brow.mid.*"}, "out": [0, 8], "mode": "add"}'
joy='{"from": {"channel": "lefty"}, "to": {"pose": "joy"}, "mode": "add", "bend": 0.3}'
smile='{"from": {"channel": "cc.1"}, "to": {"param": "smile_gain"}, "out": [50, 200], "pickup": true}'
gaze='{"from": {"input": "performer", "channel": "right.wrist.yaw"}, "to": {"dof": "eye.*.yaw"}}'
mark='{"from": {"channel": "button.mark"}, "to": {"action": "mark"}}'
patch_of all.json "$jaw, $brows, $joy, $smile, $gaze, $mark"
patch_of less.json "$brows, $joy, $smile, $gaze, $mark"

perform() { # patch [more]
    local patch=$1
    shift
    "$MAROTTE" perform --verbose --face "$puppet" --input "log:$demo,end=2" --input log:faders.csv \
        --map one_hand ${patch:+--patch "$patch"} "$@" >said 2>stderr ||
        fail "perform --patch $patch: $(cat stderr)"
}
sum_of() { # take
    "$MAROTTE" take show "$show" "$1" --hash | sed -n 's/^SHA-256 *//p'
}

perform all.json --record "$show" --export performed.pc2
! grep -q "note: patch" stderr || fail "all of it is there: $(cat stderr)"
"$MAROTTE" take export "$show" 1 --export played.pc2 >said 2>stderr || fail "$(cat stderr)"
cmp -s performed.pc2 played.pc2 || fail "a patched take shows another face than was performed"
perform all.json --export again.pc2
cmp -s performed.pc2 again.pc2 || fail "the same hands, faders and patch give another face"
perform '' --export bare.pc2
! cmp -s performed.pc2 bare.pc2 || fail "a patch moves nothing"
perform less.json --export less.pc2
! cmp -s performed.pc2 less.pc2 || fail "without the jaw's fader the jaw is the same"
sqlite3 "$show" "SELECT count(*) FROM event WHERE kind = 6" 2>/dev/null | grep -qx 1 || fail "no mark was set"
"$MAROTTE" take show "$show" 1 | grep -q '^mark .*s: mark$' || fail "the mark is no marker of its take"

# Changed afterwards.
first=$(sum_of 1)
"$MAROTTE" take remap "$show" 1 --patch less.json >said 2>stderr || fail "remap: $(cat stderr)"
"$MAROTTE" take export "$show" 2 --export remapped.pc2 >said 2>stderr || fail "$(cat stderr)"
cmp -s remapped.pc2 less.pc2 || fail "remapped it is not what that patch performs"
[ "$(sum_of 1)" = "$first" ] || fail "a remap changes the old take"
"$MAROTTE" take remap "$show" 1 --patch none >said 2>stderr || fail "remap none: $(cat stderr)"
"$MAROTTE" take export "$show" 3 --export none.pc2 >said 2>stderr || fail "$(cat stderr)"
cmp -s none.pc2 bare.pc2 || fail "without a patch it is not the bare performance"
"$MAROTTE" take remap "$show" 3 --patch all.json >said 2>stderr || fail "remap back: $(cat stderr)"
"$MAROTTE" take export "$show" 4 --export back.pc2 >said 2>stderr || fail "$(cat stderr)"
cmp -s back.pc2 performed.pc2 || fail "patched again it is not the first performance"

# Faders alone move a face, no hand there; shipped patches fit both faces.
"$MAROTTE" perform --verbose --face "$puppet" --input log:faders.csv --map one_hand --patch all.json --export alone.pc2 \
    >said 2>stderr || fail "faders alone: $(cat stderr)"
[ "$(fact 'range of motion' said)" != 0.00 ] || fail "faders alone move nothing"
for name in faders gamepad phone voice; do
    perform "$name" --seconds 0.2
    ! grep -q "note: patch" stderr || fail "$name: $(cat stderr)"
done
perform phone_face --seconds 0.2
[ "$(grep "note: patch" stderr | grep -cv skull.tilt)" = 0 ] || fail "phone_face: $(cat stderr)"
"$MAROTTE" perform --verbose --face moai --input log:faders.csv --map one_hand --patch faders --seconds 0.2 >said 2>stderr ||
    fail "moai: $(cat stderr)"

# Their channels are those of the inputs.
for at in gamepad:gamepad/pad.c phone:phone/phone_parse.c phone_face:phone/phone_parse.c; do
    for channel in $(sed -nE 's/.*"channel": "([^"]+)".*/\1/p' "$SOURCE_DIR/ui/patches/${at%%:*}.json" | sort -u); do
        grep -qF "\"$channel\"" "$SOURCE_DIR/plugins/${at#*:}" || fail "${at%%:*}: no channel $channel"
    done
done

# What is not there is said; what makes no sense is refused.
patch_of odd.json '{"from": {"channel": "x"}, "to": {"param": "waldo"}},
    {"from": {"channel": "x"}, "to": {"dof": "tail.wag"}}, {"from": {"channel": "x"}, "to": {"pose": "waldo"}},
    {"from": {"channel": "x"}, "to": {"contact": "horn.*"}}'
perform odd.json --seconds 0.2
for words in 'no parameter "waldo"' 'no degree of freedom "tail.wag"' 'no pose "waldo"' 'no contact "horn.*"'; do
    grep -qF "$words" stderr || fail "$words is not said: $(cat stderr)"
done
bad() { # words connection
    patch_of bad.json "$2"
    refused 1 "$1" "$MAROTTE" perform --face "$puppet" --input log:faders.csv --map one_hand --patch bad.json
}
bad '$.connections[0].from: expected an object' '{"to": {"dof": "jaw.open"}}'
bad '$.connections[0].from.channel: is missing' '{"from": {}, "to": {"dof": "jaw.open"}}'
bad 'unknown key "gamma"' '{"from": {"channel": "x"}, "to": {"dof": "jaw.open"}, "gamma": 1}'
bad 'smooth_s: is not within 0 and 10' '{"from": {"channel": "x"}, "to": {"dof": "jaw.open"}, "smooth_s": 11}'
bad 'to: expected one of' '{"from": {"channel": "x"}, "to": {"dof": "jaw.open", "pose": "joy"}}'
bad 'in: is not two ascending' '{"from": {"channel": "x"}, "to": {"dof": "jaw.open"}, "in": [1, 0]}'
bad 'is not record, stop or mark' '{"from": {"channel": "x"}, "to": {"action": "explode"}}'
bad 'not JSON' '{{{'
refused 1 'waldo' "$MAROTTE" perform --face "$puppet" --input log:faders.csv --map one_hand --patch waldo
refused 1 'bad.json' "$MAROTTE" take remap "$show" 1 --patch bad.json
exit $((failures > 0))
