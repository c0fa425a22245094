#!/usr/bin/env bash
# Real recordings perform the Moai through both of the paper's mappings and the puppet with one hand in its three modes:
# all of it is read, nothing is non-finite, no fold goes unreported, the export keeps its word; and with a rig nothing
# folds and no skin enters the skull. Every sample is performed. Each recording takes its turn at the mappings and 12 pictures of a
# second are looked at; in ./test --long each goes through all of them, with all 60 (MAROTTE_RECORDINGS_FPS).
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
maps=(anchored unanchored one_hand one_hand,mode=mask one_hand,mode=layered_waldo)
facts=$scratch/facts.txt
for i in "${!maps[@]}"; do
    map=${maps[i]} tried=("${recordings[@]}")
    [ -n "${MAROTTE_RECORDINGS_FPS:-}" ] || tried=("${recordings[(i < 3 ? i : 5 - i) % ${#recordings[@]}]}") # the longest once
    for recording in "${tried[@]}"; do
        face=$moai
        [ "$map" = "${map#one_hand}" ] || face=$puppet
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
        fi
        awk -v mib="$(fact 'peak memory' "$facts")" -v most="$most_mib" \
            'BEGIN { exit !(mib < most) }' ||
            fail "$(fact 'peak memory' "$facts") MiB of memory"
    done
done
finish
