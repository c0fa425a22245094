#!/usr/bin/env bash
# Real recordings perform the Moai as clay and the puppet, through both of the paper's mappings, and the puppet with one hand in its
# three modes. Every sample is read and performed, nothing is non-finite, folds are reported, and the export is within its tolerance.
# The puppet never folds, its skin does not enter the skull and its lips do not pass into each other. Each mapping performs one
# recording, at 12 pictures a second. ./test --long performs all of them, at 60 (MAROTTE_RECORDINGS_FPS).
source "$(dirname "$0")/lib.sh"
if [ ! -d "$shared/data/hands" ]; then
    echo "SKIPPED: no recordings in $shared/data/hands (set MAROTTE_SHARED)"
    exit 77
fi
most_mib=300 fps=${MAROTTE_RECORDINGS_FPS:-12} recordings=("$shared"/data/hands/*.txt)
if [ -n "${SANITIZED:-}" ]; then
    most_mib=1200                  # the sanitizer's own
    recordings=("${recordings[-1]}") # the same code, ten times slower
fi
maps=(moai:anchored moai:unanchored puppet:one_hand "puppet:one_hand,mode=mask" "puppet:one_hand,mode=layered_waldo"
    puppet:anchored puppet:unanchored)
facts=$scratch/facts.txt apart=${BUILD_DIR:-$SOURCE_DIR/build/release}/tests/bench/heads_apart
for i in "${!maps[@]}"; do
    map=${maps[i]#*:} tried=("${recordings[@]}")
    [ -n "${MAROTTE_RECORDINGS_FPS:-}" ] || tried=("${recordings[(i < 3 ? i : i == 4 ? 1 : 2) % ${#recordings[@]}]}") # the longest once, on the Moai
    for recording in "${tried[@]}"; do
        face=$moai
        [ "${maps[i]%%:*}" = moai ] || face=$puppet
        "$MAROTTE" perform --verbose --face "$face" --input "log:$recording" --map "$map" --fps "$fps" \
            --export "$scratch/a.glb" --export "$scratch/a.pc2" >"$facts" ||
            { fail "$(basename "$recording") $map"; continue; }
        echo "--- $(basename "$recording"), $map"
        cat "$facts"
        records=$(grep -c . "$recording")
        [ "$(fact 'samples read' "$facts")" -eq "$records" ] ||
            fail "$(basename "$recording"): $(fact 'samples read' "$facts") of $records samples"
        awk -v e="$(fact 'greatest error' "$facts")" -v t="$(fact tolerance "$facts")" \
            'BEGIN { exit !(e <= t) }' || fail "the glTF misses its tolerance"
        if [ "$face" = "$puppet" ]; then
            [ "$(fact folds "$facts")" -eq 0 ] || fail "the puppet folds"
            awk -v mm="$(fact penetration "$facts")" 'BEGIN { exit !(mm < 0.01) }' ||
                fail "skin enters the skull by $(fact penetration "$facts") mm"
            read -r _ _ overlap < <("$apart" "$face" "$scratch/a.pc2")
            echo "lips pass into each other by ${overlap:-?} mm at most"
            awk -v mm="${overlap:-1}" 'BEGIN { exit !(mm <= 0.3) }' || fail "lips pass into each other by ${overlap:-?} mm"
        fi
        awk -v mib="$(fact 'peak memory' "$facts")" -v most="$most_mib" \
            'BEGIN { exit !(mib < most) }' ||
            fail "$(fact 'peak memory' "$facts") MiB of memory"
    done
done
finish
