#!/usr/bin/env bash
# A glove is calibrated from a log in counts, the calibration is used, shown, imported and rewritten;
# whatever is wrong is one clear line, and an old calibration is only replaced by a complete one.
source "$(dirname "$0")/lib.sh"
glove=$scratch/glove.csv
user=$scratch/user.json
log() { awk -f "$SOURCE_DIR/tests/e2e/calibrate_glove.awk" "$@"; }
calibrate() { "$MAROTTE" calibrate "$@"; }
json() { sed -nE "s/^ *\"$1\": ([-0-9.]+|\"[^\"]*\"),?$/\1/p" "$2" | tr -d '"'; }
log >"$glove"

# The whole way: no terminal, so it goes on by stillness alone.
calibrate --input "log:$glove" --out "$user" --name anna --hand-length 182 </dev/null \
    >"$scratch/said.txt" || fail "calibrate"
for step in "relaxed hand" "flat hand" fist "thumb across" "fingers spread" "little alone"; do
    grep -q "^  taken: $step\$" "$scratch/said.txt" || fail "\"$step\" was not taken"
done
grep -qP '\x1b' "$scratch/said.txt" && fail "control sequences though stdout is no terminal"
calibrate --show "$user" --json >"$scratch/shown.json" || fail "calibrate --show"
[ "$(json hand "$scratch/shown.json")" = right ] || fail "it is a right hand"
[ "$(json sensor_count "$scratch/shown.json")" = 18 ] || fail "the glove has 18 sensors"
[ "$(json sensors_measured "$scratch/shown.json")" = 15 ] || fail "15 sensors are measured"
[ "$(json sensors_zeroed "$scratch/shown.json")" = 3 ] || fail "arch and wrist have a zero"
[ "$(json hand_length_mm "$scratch/shown.json")" = 182.0 ] || fail "the hand is 182 mm long"
grep -q '"middle.mpj .*moves index.mpj 0.20 ring.mpj 0.50' "$scratch/shown.json" || fail "cross-talk"
# The glove has a count a degree at the index knuckle: 45 degrees above 90 are 135 counts.
grep -q '"index.mpj": {"source": "measured", "points": .*\[90.0, 0.0\]' "$user" || fail "zero"

# To the same file: what marotte does not know stays, the name too.
sed -i 's/^{$/{ "shoe_size": 38,/' "$user"
calibrate --input "log:$glove" --out "$user" --json </dev/null >"$scratch/again.json" \
    2>"$scratch/again.txt" || fail "calibrate again"
grep -q '"shoe_size": 38' "$user" || fail "an unknown key is lost"
grep -q 'note: .*shoe_size' "$scratch/again.txt" || fail "an unknown key is not reported"
[ "$(json name "$scratch/again.json")" = anna ] || fail "the name is lost"
[ "$(head -c 1 "$scratch/again.json")" = "{" ] || fail "--json prints more than JSON"

# An incomplete one, or one that is none, leaves the old file as it is.
cp "$user" "$scratch/before.json"
log -v poses=6 >"$scratch/short.csv"
refused 1 "the input ended in step 7 of 10, index alone" "$MAROTTE" calibrate \
    --input "log:$scratch/short.csv" --out "$user"
cmp "$user" "$scratch/before.json" || fail "an incomplete calibration replaced the old one"
echo '{"other": 1}' >"$scratch/other.json"
refused 1 "not overwritten, because it is not a calibration" "$MAROTTE" calibrate \
    --input "log:$glove" --out "$scratch/other.json"
grep -q other "$scratch/other.json" || fail "another file was overwritten"
# One dead sensor is said, and keeps the shipped gain.
log -v broken=ring.mpj >"$scratch/broken.csv"
calibrate --input "log:$scratch/broken.csv" --out "$scratch/broken.json" </dev/null \
    >"$scratch/broken.txt" || fail "a glove with a dead sensor"
grep -q 'taken: fist; 1 of 8 sensors hardly moved.*ring knuckle by 0 ' "$scratch/broken.txt" ||
    fail "the dead sensor is not named"
grep -q 'ring.mpj *zeroed' "$scratch/broken.txt" || fail "the dead sensor is not zeroed"

grep -q '^ *flaw  *ring knuckle: hardly moved.*Repeat: fist' "$scratch/broken.txt" ||
    fail "the dead sensor is no flaw: $(grep -i flaw "$scratch/broken.txt")"
grep -q 'All poses are done, but 1 sensor is not right' "$scratch/broken.txt" || fail "no judgement"
grep -q 'All poses are done\.' "$scratch/said.txt" || fail "a good calibration is not called good"
[ "$(json flaw_count "$scratch/shown.json")" = 0 ] || fail "a good calibration has flaws"

# A residual that is nonsense is said of a file too.
sed -E 's/("middle.pij": .*"residual_rad": )[0-9.]+/\11.71/' "$user" >"$scratch/nonsense.json"
calibrate --show "$scratch/nonsense.json" >"$scratch/nonsense.txt" || fail "--show of nonsense"
grep -q 'middle finger, middle joint: reads 98 degrees' "$scratch/nonsense.txt" ||
    fail "a residual of 98 degrees is not said"

# What cannot be calibrated.
refused 1 "of 3, fingers spread: the hand did not reach the pose" "$MAROTTE" calibrate --input "log:$demo" --out "$scratch/out/a.json"
refused 1 "measures the right hand, not the left hand" "$MAROTTE" calibrate \
    --input "log:$glove" --hand left --out "$scratch/out/a.json"
refused 1 "none.csv" "$MAROTTE" calibrate --input "log:$scratch/none.csv" \
    --out "$scratch/out/a.json"
refused 2 "--out FILE is missing" "$MAROTTE" calibrate --input "log:$glove"
refused 2 "one of --input" "$MAROTTE" calibrate --out "$scratch/out/a.json"
refused 2 "not left or right" "$MAROTTE" calibrate --input log --hand up --out x
refused 1 "1 to 63 letters" "$MAROTTE" calibrate --input "log:$glove" --name a/b
refused 1 "\$.marotte_calibration: expected 1" "$MAROTTE" calibrate --show "$scratch/other.json"

# Use: the shipped defaults with a hint, then the newest of the folder, then one by name.
log -v tail=1 >"$scratch/use.csv"
perform() {
    "$MAROTTE" perform --verbose --face "$moai" --input "log:$scratch/use.csv" --map anchored \
        --export "$scratch/$1.csv" "${@:2}" >"$scratch/$1.txt" 2>"$scratch/$1.err" ||
        fail "perform $1: $(cat "$scratch/$1.err")"
}
perform shipped
grep -q "note: the right hand is not calibrated; the shipped defaults are used. Calibrate it: marotte calibrate" \
    "$scratch/shipped.err" || fail "no hint for an uncalibrated hand"
calibrate --input "log:$glove" --name bea </dev/null >/dev/null || fail "into the folder"
[ -s "$XDG_CONFIG_HOME/marotte/calibrations/bea.json" ] || fail "not in the user's folder"
perform newest
grep -q "note: right hand: .*/bea.json (bea, 20" "$scratch/newest.err" || fail "newest is not said"
grep -q "^calibration .*bea.json" "$scratch/newest.txt" || fail "newest is no fact"
cmp -s "$scratch/shipped.csv" "$scratch/newest.csv" && fail "a calibration changes nothing"
perform named --calibration "$XDG_CONFIG_HOME/marotte/calibrations/bea.json"
cmp "$scratch/named.csv" "$scratch/newest.csv" || fail "the same calibration by name differs"
perform none --calibration none
cmp "$scratch/none.csv" "$scratch/shipped.csv" || fail "--calibration none is not the defaults"
refused 1 "one calibration per hand" "$MAROTTE" perform --face "$moai" --input "log:$glove" \
    --map anchored --calibration "$user" --calibration "$scratch/before.json"
refused 1 "other.json: \$.marotte_calibration" "$MAROTTE" perform --face "$moai" \
    --input "log:$glove" --map anchored --calibration "$scratch/other.json"
# A log in rad has no use for one.
"$MAROTTE" perform --face "$moai" --input "log:$demo,end=1" --map anchored 2>"$scratch/rad.err" \
    >/dev/null || fail "perform in rad"
[ -s "$scratch/rad.err" ] && fail "a log in rad speaks of calibrations: $(cat "$scratch/rad.err")"

# A bare hand: flat, fist and spread, as a camera sees them: bent by 8 degrees when straight, and too little.
awk 'function row(t, bend, spread) {
    printf "%.3f,%.4f,%.4f,%.4f,%.4f,%.4f\n", t, 0.14 + 0.7 * bend, 0.14 + 0.7 * bend, 0.1 + 0.6 * bend,
        0.02 + 0.5 * spread, 0.1 + 0.4 * bend }
BEGIN { print "time_s,right.index.mpj,right.middle.mpj,right.ring.mpj,right.middle.abd,right.thumb.mpj"; print "unit,rad,rad,rad,rad,rad"
    for (i = 0; i < 240; ++i) { t = i / 30
        row(t, t < 2 ? 0 : t < 2.6 ? (t - 2) / 0.6 * 1.57 : t < 5 ? 1.57 : t < 5.6 ? (5.6 - t) / 0.6 * 1.57 : 0,
            t < 5 ? 0 : t < 5.6 ? (t - 5) / 0.6 * 0.3 : 0.3) } }' >"$scratch/bare.csv"
calibrate --input "log:$scratch/bare.csv" --name anna </dev/null >"$scratch/bare.txt" || fail "a bare hand"
[ "$(grep -c '^step [123] of 3, ' "$scratch/bare.txt")" -eq 3 ] || fail "not three poses: $(cat "$scratch/bare.txt")"
bare=$XDG_CONFIG_HOME/marotte/calibrations/anna,\ log.json
grep -q '"input": "log"' "$bare" || fail "a bare hand's calibration does not say whose angles it reads"
grep -q '"index.mpj": {"source": "measured", "points": .*\[0.14, 0.0\]' "$bare" || fail "flat is no 0: $(cat "$bare")"
perform_bare() {
    "$MAROTTE" perform --verbose --face "$moai" --input "log:$scratch/$1" --map anchored --export "$scratch/bare.$2.csv" \
        "${@:3}" >"$scratch/bare.txt" 2>"$scratch/bare.err" || fail "perform $2: $(cat "$scratch/bare.err")"
}
perform_bare bare.csv seen
grep -q 'calibrat' "$scratch/bare.err" && fail "a recording in rad speaks of calibrations: $(cat "$scratch/bare.err")"
perform_bare bare.csv mine --calibration "$bare" --record "$scratch/bare.marotte" --export "$scratch/bare.mine.pc2"
cmp -s "$scratch/bare.seen.csv" "$scratch/bare.mine.csv" && fail "a bare hand's calibration changes nothing"
"$MAROTTE" take export "$scratch/bare.marotte" last --export "$scratch/bare.take.pc2" >/dev/null 2>&1 || fail "the take"
cmp "$scratch/bare.mine.pc2" "$scratch/bare.take.pc2" || fail "the take is read with another calibration"
# A glove is not read with it, nor the bare hand with a glove's.
perform not_mine --calibration "$bare"
cmp "$scratch/not_mine.csv" "$scratch/shipped.csv" || fail "counts are read as if they were angles"
grep -q 'not used: no log provides a right hand' "$scratch/not_mine.err" || fail "$(cat "$scratch/not_mine.err")"
perform_bare bare.csv glove --calibration "$scratch/broken.json"
cmp "$scratch/bare.glove.csv" "$scratch/bare.seen.csv" || fail "angles are read as if they were counts"
refused 1 "is a calibration of a glove. Choose another name" "$MAROTTE" calibrate --input "log:$scratch/bare.csv" --out "$user"

# A sender without a calibration is told the command, port and all.
port=$((20000 + $$ % 10000))
"$MAROTTE" perform --face "$moai" --map anchored --input "osc:127.0.0.1:$port" --seconds 0.2 \
    >/dev/null 2>"$scratch/hint.err" # nobody sends: it ends without a face
grep -q "calibrate --input osc:127.0.0.1:$port --name NAME" "$scratch/hint.err" ||
    fail "the hint is no command for this sender: $(cat "$scratch/hint.err")"

# A pedal in the log re-zeroes, the same in every replay; while the hand moves it is refused.
awk -F, -v OFS=, 'NR == 1 { print $0, "pedal.1"; next } NR == 2 { print $0, "1"; next }
    { print $0, ($1 >= 1.5 && $1 < 1.7) || ($1 >= 2.3 && $1 < 2.4) ? 1 : 0 }' \
    "$scratch/use.csv" >"$scratch/pedal.csv"
for run in 1 2; do
    "$MAROTTE" perform --verbose --face "$moai" --input "log:$scratch/pedal.csv" --map anchored \
        --rezero-pedal 1 --export "$scratch/pedal$run.csv" >"$scratch/pedal.txt" 2>/dev/null ||
        fail "perform with a pedal"
done
cmp "$scratch/pedal1.csv" "$scratch/pedal2.csv" || fail "a re-zero replays differently"
[ "$(fact re-zeros "$scratch/pedal.txt")" = 1 ] || fail "the pedal re-zeroes once"
grep -q "^  refused *1 the right hand is not still: its" "$scratch/pedal.txt" ||
    fail "a re-zero of a moving hand is not refused: $(grep -A1 re-zeros "$scratch/pedal.txt")"

# VirtualHand.
{ echo 'VHv1.6'; echo 'GLOVE CALIBRATION follows:'; for k in 0 1 2 3 4 5; do echo "FINGER $k:"
    for j in 0 1 2 3; do echo "  $j 90 0.012 0"; done; done; } >"$scratch/user.cal"
calibrate --from-virtualhand "$scratch/user.cal" --hand right --out "$scratch/vh.json" \
    >"$scratch/vh.txt" || fail "--from-virtualhand"
grep -q "  imported *22" "$scratch/vh.txt" || fail "22 sensors are not imported"
perform imported --calibration "$scratch/vh.json"
refused 1 "Use --hand left or --hand right" "$MAROTTE" calibrate \
    --from-virtualhand "$scratch/user.cal" --out "$scratch/out/a.json"
echo "Device 1 2 3" >"$scratch/dcu.cal"
refused 1 "Device Configuration Utility" "$MAROTTE" calibrate --from-virtualhand "$scratch/dcu.cal" \
    --hand left --out "$scratch/out/a.json"

# At a terminal: bars in place, and it does not wait for a person when a log plays.
if command -v script >/dev/null; then
    TERM=xterm timeout 60 script -qec "'$MAROTTE' calibrate --input 'log:$glove' \
        --out '$scratch/tty.json'" /dev/null </dev/null >"$scratch/tty.txt" || fail "at a terminal"
    grep -q 'index.mpj   \[' "$scratch/tty.txt" || fail "no bars at a terminal"
    [ -s "$scratch/tty.json" ] || fail "no calibration from a terminal"
fi
"$MAROTTE" calibrate --help | grep -q -- --from-virtualhand || fail "calibrate --help"
finish
