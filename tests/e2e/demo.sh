#!/usr/bin/env bash
# The demo speaks: lips close at each m, b and p of its sentence, the jaw opens at its vowels, it looks
# at you four seconds in, nothing folds, and the video has its voice.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
log=$SOURCE_DIR/plugins/log
"$MAROTTE" perform --verbose --face puppet --input log:demo --map one_hand --fps 100 --export demo.csv >said 2>stderr ||
    fail "log:demo: $(cat stderr)"
[ "$(fact folds said)" -eq 0 ] || fail "the face folds"
column() { head -1 demo.csv | tr , '\n' | grep -n "^$1\$" | cut -d: -f1; }
seal=$(column lips.seal) jaw=$(column jaw.open) yaw=$(column eye.l.yaw) time=$(column time_s)
[ -n "$seal" ] && [ -n "$jaw" ] && [ -n "$yaw" ] || fail "columns: $(head -1 demo.csv)"
# Of each phoneme (demo_phonemes.csv: when it begins, its name) the greatest value from 50 ms before it
# until the next begins.
awk -F, -v seal="$seal" -v jaw="$jaw" -v time="$time" '
    FNR == NR { if ($1 ~ /^[0-9]/) { to[n - 1] = $1; from[n] = $1; to[n] = $1 + 0.1; name[n] = $2; n += 1 }; next }
    FNR > 1 { for (i = 0; i < n; ++i) if ($time >= from[i] - 0.05 && $time <= to[i]) {
        if ($seal > sealed[i]) sealed[i] = $seal
        if ($jaw > open[i]) open[i] = $jaw } }
    END { for (i = 0; i < n; ++i) {
        if (name[i] ~ /^[mbp]/) { lips += 1; if (sealed[i] < 0.99) { print name[i] " at " from[i] " s: sealed " sealed[i]; bad += 1 } }
        if (open[i] > widest) widest = open[i] }
        print lips " closures, jaw " widest
        exit bad > 0 || lips < 4 || widest < 0.15 }' "$log/demo_phonemes.csv" demo.csv >closures || fail "$(cat closures)"
cat closures
# Mouths in the middle of a phoneme that differ from each other by 10 mm and more: sum over lips and corners, and the jaw at 50 mm.
mouths=$(awk -F, -v time="$time" -v jaw="$jaw" '
    FNR == NR { if ($1 ~ /^[0-9]/) { at[n - 1] = (at[n - 1] + $1) / 2; at[n++] = $1 } next }
    FNR == 1 { for (c = 1; c <= NF; ++c) if ($c ~ /^(mouth\.corner|lip)\..*\.[xyz]$/) use[c] = 1; next }
    i < n - 1 && $time >= at[i] { i += 1; is_new = 1
        for (k = 0; k < count && is_new; ++k) { sum = (50 * ($jaw - open[k])) ^ 2
            for (c in use) sum += ($c - was[k, c]) ^ 2
            is_new = sum > 100 }
        if (is_new) { open[count] = $jaw; for (c in use) was[count, c] = $c; count += 1 } }
    END { print count + 0 }' "$log/demo_phonemes.csv" demo.csv)
[ "$mouths" -ge 10 ] || fail "only $mouths different mouths"
echo "$mouths different mouths"
awk -F, -v yaw="$yaw" -v time="$time" 'FNR > 1 && $time >= 4.0 { exit !($yaw < 0.1 && $yaw > -0.1) }' demo.csv || fail "4 s in it looks aside"
"$MAROTTE" perform --verbose --face puppet --input log:emotions --map one_hand >said 2>stderr || fail "log:emotions: $(cat stderr)"
[ "$(fact folds said)" -eq 0 ] || fail "log:emotions: the face folds"
refused=$("$MAROTTE" perform --face puppet --input log:dmeo --map one_hand 2>&1) && fail "log:dmeo performs"
grep -q 'Did you mean "demo"' <<<"$refused" || fail "log:dmeo: $refused"

# ---- the voice ----
if ! command -v ffprobe >/dev/null; then
    echo "SKIPPED: ffmpeg is not installed: the video was not made"
    finish
elif "$MAROTTE" perform --face puppet --input log:demo,end=3 --map one_hand --size 160x90 --fps 10 --export demo.mp4 >said 2>stderr; then
    sound=$(ffprobe -v error -select_streams a -show_entries stream=duration -of csv=p=0 demo.mp4)
    awk -v s="$sound" 'BEGIN { exit !(s > 2.9 && s < 3.2) }' || fail "the sound is $sound s long"
    cp "$log/demo.csv" mine.csv && echo "this is no sound" >mine.ogg
    "$MAROTTE" perform --face puppet --input log:mine.csv,end=1 --map one_hand --size 160x90 --fps 10 --export mine.mp4 >said 2>stderr ||
        fail "a damaged sound: $(cat stderr)"
    grep -q 'the video has no sound: ' stderr || fail "a damaged sound is not reported: $(cat stderr)"
elif grep -q EGL stderr; then
    echo "SKIPPED: $(cat stderr)"
else
    fail "video: $(cat stderr)"
fi
finish
