#!/usr/bin/env bash
# Every real recording performs the Moai through both mappings: all of it is read, nothing is
# non-finite, no fold goes unreported, and the export keeps its word.
source "$(dirname "$0")/lib.sh"
if [ ! -d "$shared/data/hands" ]; then
    echo "SKIPPED: no recordings in $shared/data/hands (set MAROTTE_SHARED)"
    exit 77
fi
for recording in "$shared"/data/hands/*.txt; do
    records=$(grep -c . "$recording")
    for map in anchored unanchored; do
        facts=$scratch/facts.txt
        "$MAROTTE" perform --face "$moai" --input "log:$recording" --map $map \
            --export "$scratch/a.glb" --export "$scratch/a.pc2" >"$facts" ||
            { fail "$(basename "$recording") $map"; continue; }
        echo "--- $(basename "$recording"), $map"
        cat "$facts"
        [ "$(fact 'samples read' "$facts")" -eq "$records" ] ||
            fail "$(basename "$recording"): $(fact 'samples read' "$facts") of $records samples"
        awk -v e="$(fact 'greatest error' "$facts")" -v t="$(fact tolerance "$facts")" \
            'BEGIN { exit !(e <= t) }' || fail "the glTF misses its tolerance"
        awk -v mib="$(fact 'peak memory' "$facts")" 'BEGIN { exit !(mib < 300) }' ||
            fail "$(fact 'peak memory' "$facts") MiB of memory"
    done
done
finish
