#!/usr/bin/env bash
# How near the poses of drafted heads come to the heads' own shapes, which the draft does not see: what
# bench_carried prints. The means must stay as near as they are, and a frown must be one.
source "$(dirname "$0")/../e2e/lib.sh"
if [ ! -d "$shared/data/faces" ]; then
    echo "SKIPPED: no $shared/data/faces (set MAROTTE_SHARED)"
    exit 77
fi
program=${BUILD_DIR:-$SOURCE_DIR/build/release}/tests/bench/bench_carried
for row in "faces/ict_face.glb 0.71" "heads/rpm_arkit.glb 0.78"; do
    read -r head most <<<"$row"
    echo "$head"
    "$program" "$shared/data/$head" "$SOURCE_DIR/rigs/puppet/puppet.rig.json" >"$scratch/out.txt" || { fail "$head: bench_carried"; continue; }
    cat "$scratch/out.txt"
    awk -v most="$most" '
        $1 == "mouthFrownLeft" { frown = $3 }
        $1 == "mean" { mean = $2 }
        END { exit !(mean > 0 && mean <= most && frown >= 0.4) }
    ' "$scratch/out.txt" || fail "$head: mean residual above $most, or a frown of another direction"
done
finish
