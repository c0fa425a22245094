#!/usr/bin/env bash
# A hand of an OpenXR runtime performs, live; the take performs again bit for bit; a runtime that
# crashes ends no performance.
source "$(dirname "$0")/lib.sh"
[ -x "$BUILD_DIR/marotte-openxr-hands" ] || { echo "SKIPPED: libopenxr-dev is not installed"; exit 77; }
cd "$scratch" || exit 1
export XR_RUNTIME_JSON=$BUILD_DIR/tests/device/openxr_runtime.json

# Until the hand has moved the face and WORDS are said: where others work, a runtime takes its time to start.
perform() { # words
    local words=$1
    for seconds in 3 10 30; do
        rm -f taken.marotte
        "$MAROTTE" perform --verbose --face "$puppet" --seconds $seconds --input openxr --map one_hand --record taken.marotte \
            >said 2>stderr || fail "$MAROTTE_TEST_OPENXR: $(cat stderr)"
        [ "$(fact 'range of motion' said)" != 0.00 ] && grep -q "$words" stderr && return
    done
    fail "$MAROTTE_TEST_OPENXR: the hand moves nothing, or nobody says \"$words\": $(cat said stderr)"
}

for mode in good crash; do
    export MAROTTE_TEST_OPENXR=$mode
    perform "$([ $mode = good ] && echo 'hands come from' || echo 'runtime crashed')"
    [ "$(grep -c 'runtime crashed' stderr)" -eq "$([ $mode = crash ] && echo 1 || echo 0)" ] ||
        fail "a crash is one sentence: $(cat stderr)"
    for again in 1 2; do
        "$MAROTTE" take export taken.marotte last --export $mode.$again.pc2 >said 2>stderr || fail "$mode: $(cat stderr)"
    done
    cmp $mode.1.pc2 $mode.2.pc2 || fail "$mode: the take performs otherwise the second time"
done

"$MAROTTE" devices >said 2>&1 || fail "devices: $(cat said)"
grep -q 'openxr' said || fail "the runtime is not listed: $(cat said)"
refused 1 'takes no address' "$MAROTTE" perform --face "$puppet" --map one_hand --input openxr:waldo
finish
