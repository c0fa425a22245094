#!/usr/bin/env bash
# The ICT face's own shapes on random mixtures of them: what bench_shapes prints must hold.
#   shapes.sh [MIXTURES]   8 by default; the figures of the notes are those of 200, seed 7
source "$(dirname "$0")/../e2e/lib.sh"
if [ ! -d "$shared/data/faces" ]; then
    echo "SKIPPED: no $shared/data/faces (set MAROTTE_SHARED)"
    exit 77
fi
export MAROTTE_FILE_FOLDERS=$shared/data/faces # the rig names a mesh that lies elsewhere
sed "s#\"mesh\": *\"[^\"]*\"#\"mesh\": \"$shared/data/faces/ict_face.glb\"#" \
    "$SOURCE_DIR/tests/face/ict.rig.json" >"$scratch/ict.rig.json"
program=${BUILD_DIR:-$SOURCE_DIR/build/release}/tests/bench/bench_shapes
# The last two: what half of a mixture's shapes say of the jaw should not be believed.
for row in "shapes18 0.10 ${1:-8} 7" "shapes10 0.20 ${1:-8} 7" \
    "shapes10 0.20 1 2625696821010414735" "shapes10 0.20 1 1226915544090939395"; do
    read -r set most mixtures seed <<<"$row"
    "$program" "$scratch/ict.rig.json" "$set" "$mixtures" "$seed" >"$scratch/out.txt" ||
        { fail "$set: bench_shapes"; continue; }
    cat "$scratch/out.txt"
    awk -v most="$most" '
        /^shapes first/ { residual = $4; miss = $7 }
        /^withheld over fields/ { worst = $8 }
        END { exit !(residual > 0 && residual <= most && miss <= 0.05 && worst > 0 && worst <= 1.05) }
    ' "$scratch/out.txt" || fail "$set: residual above $most, a contact missed, or worse than the fields"
done
finish
