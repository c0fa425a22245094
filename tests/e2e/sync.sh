#!/usr/bin/env bash
# A face performed from a voice's file by the patch, and marotte take sync: finds by how much its mouth
# was moved, moves it back as an edit, and says what a take lacks.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
show=voice.marotte

sync() { # words of marotte take sync; the facts are in $scratch/said
    "$MAROTTE" take sync "$@" >"$scratch/said" 2>"$scratch/stderr" ||
        fail "take sync $*: $(cat "$scratch/stderr")"
}
late_ms() {
    sed -nE 's/^late by +([-0-9.]+) ms$/\1/p' "$scratch/said"
}
near() { # number wanted tolerance
    awk -v a="${1:-1e9}" -v b="$2" -v t="$3" 'BEGIN { exit !(a - b <= t && b - a <= t) }' ||
        fail "$1 instead of $2: $(cat "$scratch/said")"
}

# The voice of the demo as a WAV file, by way of a take.
"$MAROTTE" perform --face "$puppet" --input "log:$demo" --map one_hand --record hand.marotte \
    >"$scratch/out.txt" 2>&1 || fail "record: $(cat "$scratch/out.txt")"
refused 1 'The take has no sound' "$MAROTTE" take sync hand.marotte
"$MAROTTE" take audio attach hand.marotte last "$SOURCE_DIR/plugins/log/demo.ogg" >"$scratch/out.txt" 2>&1
"$MAROTTE" take export hand.marotte last --export hello.wav >"$scratch/out.txt" 2>&1 ||
    fail "export: $(cat "$scratch/out.txt")"

# Offline, without a device: the same bits each time.
for take in 1 2; do
    "$MAROTTE" perform --face "$puppet" --input voice:hello.wav --map one_hand --patch voice --record $show \
        >"$scratch/out.txt" 2>&1 || fail "perform voice:hello.wav: $(cat "$scratch/out.txt")"
    "$MAROTTE" take show $show $take --hash | grep '^SHA-256' >"sum.$take"
done
cmp sum.1 sum.2 || fail "a voice's file performs differently the second time"

"$MAROTTE" take audio attach $show 1 hello.wav >"$scratch/out.txt" 2>&1
sync $show 1
own=$(late_ms)
near "$own" 30 25
for shift in 0.2 0.1 0.035; do
    "$MAROTTE" take layer offset $show 1 1 $shift >"$scratch/out.txt" 2>&1 || fail "layer offset"
    sync $show 1
    near "$(late_ms)" "$(awk -v o="$own" -v s=$shift 'BEGIN { print o + 1000 * s }')" 10
    echo "moved by $shift s: found $(late_ms) ms, $own ms of its own"
done
sync $show 1 --move
grep -q "^edit .*offset of" "$scratch/said" || fail "no edit: $(cat "$scratch/said")"
sync $show 1
near "$(late_ms)" 0 10
"$MAROTTE" take undo $show 1 >"$scratch/out.txt" 2>&1 || fail undo
sync $show 1 --json
near "$(sed -nE 's/^ *"late_ms": ([-0-9.e+]+),?$/\1/p' "$scratch/said")" "$(awk -v o="$own" 'BEGIN { print o + 35 }')" 10

# What cannot be compared, and files that are no sound.
refused 1 'The span is too short' "$MAROTTE" take sync $show 1 --out 0.5
"$MAROTTE" perform --face "$puppet" --input voice:hello.wav --map one_hand --record still.marotte \
    >"$scratch/out.txt" 2>&1
"$MAROTTE" take audio attach still.marotte last hello.wav >"$scratch/out.txt" 2>&1
refused 1 'The jaw never moves' "$MAROTTE" take sync still.marotte
(printf '.snd\0\0\0\30\377\377\377\377\0\0\0\1\0\0\37\100\0\0\0\1'; head -c 64000 /dev/zero | tr '\0' '\377') >silent.au # silence of mu-law
"$MAROTTE" take audio attach $show 2 silent.au >"$scratch/out.txt" 2>&1
refused 1 'has no voice' "$MAROTTE" take sync $show 2
cp "$puppet" puppet.wav
refused 1 'is not a WAV file' "$MAROTTE" perform --face "$puppet" --input voice:puppet.wav --map one_hand
exit $((failures > 0))
