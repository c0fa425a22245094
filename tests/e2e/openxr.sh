#!/usr/bin/env bash
# A hand of an OpenXR runtime performs, live; the take performs again bit for bit; a runtime that
# crashes ends no performance.
source "$(dirname "$0")/lib.sh"
[ -x "$BUILD_DIR/marotte-openxr-hands" ] || { echo "SKIPPED: libopenxr-dev is not installed"; exit 77; }
cd "$scratch" || exit 1
export XR_RUNTIME_JSON=$BUILD_DIR/tests/device/openxr_runtime.json

for mode in good crash; do
    export MAROTTE_TEST_OPENXR=$mode
    "$MAROTTE" perform --face "$puppet" --seconds 3 --input openxr --map one_hand --record $mode.marotte \
        >said 2>stderr || fail "$mode: $(cat stderr)"
    for again in 1 2; do
        "$MAROTTE" take export $mode.marotte last --export $mode.$again.pc2 >said 2>stderr || fail "$mode: $(cat stderr)"
        [ "$(fact 'range of motion' said)" != 0.00 ] || fail "$mode: the hand moves nothing"
        mv "$mode.$again.pc2" "$again.pc2"
    done
    cmp 1.pc2 2.pc2 || fail "$mode: the take performs otherwise the second time"
done
"$MAROTTE" perform --face "$puppet" --seconds 3 --input openxr --map one_hand >said 2>stderr || fail "crash ends it"
[ "$(grep -c 'has crashed' stderr)" -eq 1 ] || fail "a crash is one sentence: $(cat stderr)"

"$MAROTTE" devices >said 2>&1 || fail "devices: $(cat said)"
grep -q 'openxr' said || fail "the runtime is not listed: $(cat said)"
refused 1 'no addresses' "$MAROTTE" perform --face "$puppet" --map one_hand --input openxr:waldo
finish
