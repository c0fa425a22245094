#!/usr/bin/env bash
# The examples at the end of every --help run as they stand, each in a folder that has the files that they name. Those that
# need a device or a person have to be understood: they may fail, but not as wrong usage, and they are ended. Recordings and pictures
# are cut short but in ./test --long.
source "$(dirname "$0")/lib.sh"
mkdir "$scratch/files"
cd "$scratch/files" || exit 1
export PATH=$BUILD_DIR:$PATH
take() { marotte take "$@" >"$scratch/said" 2>&1 || fail "take $*: $(cat "$scratch/said")"; }

# ---- the files ----
cp "$moai" girl.glb
cp "$SOURCE_DIR/tests/golden/o03_ten_tips_anchored.json" case.json
cp "$SOURCE_DIR/plugins/log/demo.ogg" voice.wav # a voice: its content says what it is
for shot in a b c; do
    marotte perform --face puppet --input log:demo_hand.csv,start=11,end=15 --map one_hand --record show.marotte --scene 1 \
        --shot $shot >"$scratch/said" 2>&1 || fail "perform: $(cat "$scratch/said")"
done
take timecode show.marotte 1 --fps 25 --start 01:00:00:00
take timecode show.marotte 2 --fps 25 --start 01:00:00:00
take audio attach show.marotte 2 voice.wav
take comp show.marotte last --from 2 --region brows --in 1 --out 2 # a layer, with a clip on it
take layer rename show.marotte last 3 brows
take rate show.marotte last 3
take note show.marotte last -
take undo show.marotte last --steps 2
marotte perform --face puppet --input log:demo_hand.csv,start=11,end=12 --map one_hand --export curves.csv >"$scratch/said" 2>&1 ||
    fail "curves: $(cat "$scratch/said")"
marotte plugin new wave --mapping >"$scratch/said" || fail "plugin new: $(cat "$scratch/said")"
mv wave my_wave

# ---- the examples ----
examples() { sed -n '/^Examples:/,/^$/ s/^  \(marotte.*\)/\1/p'; }
{
    marotte --help
    echo
    for command in $(marotte --help | sed -n '/^Commands:/,/^$/ s/^  \([a-z]*\) .*/\1/p'); do
        marotte help "$command" >"$scratch/help" || fail "help $command"
        [ "$(examples <"$scratch/help" | wc -l)" -ge 2 ] || fail "$command has no two examples"
        cat "$scratch/help"
        echo
    done
    while read -r verb; do
        # shellcheck disable=SC2086
        marotte help take $verb >"$scratch/help" || fail "help take $verb"
        count=$(examples <"$scratch/help" | wc -l)
        { [ "$count" -ge 2 ] && [ "$count" -le 4 ]; } || fail "take $verb has $count examples"
        cat "$scratch/help"
        echo
    done < <(marotte take --help | sed -n 's/^  \([a-z ]*[a-z]\) \[*SHOW.*/\1/p')
} >"$scratch/all"
examples <"$scratch/all" | sort -u >"$scratch/lines"
[ "$(wc -l <"$scratch/lines")" -ge 90 ] || fail "only $(wc -l <"$scratch/lines") examples were found"

count=0 parsed=0
limit_s=100 # an example that hangs
[ -z "${MAROTTE_TEST_LONG:-}" ] || limit_s=1200 # whole recordings, also under sanitizers
while read -r line; do
    if [ -z "${MAROTTE_TEST_LONG:-}" ]; then # a second of the recordings, small pictures
        line=$(sed -E 's/log:(demo_(left_)?hand)\.csv(,end=[0-9]+)?/log:\1.csv,end=1/g; s/log:demo( |$)/log:demo,end=1\1/
            s/--size [0-9]+x[0-9]+/--size 160x90/; s/rig check puppet/rig check moai/' <<<"$line")
    fi
    folder=$scratch/work
    rm -rf "$folder"
    cp -r "$scratch/files" "$folder"
    may_fail=
    case $line in
    marotte | "marotte stage"* | "marotte girl.glb" | "marotte show.marotte")
        line="$line --hidden --seconds 0.1" ;; # a window needs a display
    "marotte bench"* | "marotte paper"*) [ -n "${MAROTTE_TEST_LONG:-}" ] || may_fail=1 ;; # bench/gate and e2e/paper run these
    "marotte take sync"* | "marotte take mouth show"*) may_fail=1 ;; # they need a voice: e2e/sync and e2e/mouth have one
    "marotte calibrate --input"* | "marotte devices"* | "marotte camera"* | *"--input cyberglove"* | *"--input camera"* | \
        *"--realtime"*) may_fail=1 ;;
    esac
    [[ "$line" != "marotte take restore"* ]] || (cd "$folder" && marotte take delete show.marotte 1 && marotte take delete show.marotte last) >"$scratch/said" 2>&1
    [[ "$line" != "marotte take redo"* ]] || (cd "$folder" && marotte take rate show.marotte last 1 && marotte take rate show.marotte last 2 &&
        marotte take undo show.marotte last --steps 2) >"$scratch/said" 2>&1
    if [ -n "$may_fail" ]; then # ended after 2 s, all at the same time
        parsed=$((parsed + 1))
        mv "$folder" "$scratch/parsed$parsed"
        echo "$line" >"$scratch/line$parsed"
        (cd "$scratch/parsed$parsed" && eval "timeout 2 $line") >/dev/null 2>"$scratch/stderr$parsed" </dev/null || echo $? >"$scratch/code$parsed" &
    else
        (cd "$folder" && eval "timeout $limit_s $line") >"$scratch/said" 2>"$scratch/stderr" </dev/null ||
            fail "$line: $(tail -n 2 "$scratch/stderr")"
        count=$((count + 1))
    fi
done <"$scratch/lines"
wait
for ((i = 1; i <= parsed; ++i)); do
    [ "$(cat "$scratch/code$i" 2>/dev/null)" != 2 ] || fail "wrong usage: $(cat "$scratch/line$i" "$scratch/stderr$i")"
done
echo "$count examples ran, $parsed were understood"
finish
