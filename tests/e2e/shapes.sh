#!/usr/bin/env bash
# A downloaded head with 69 shapes of its own: drafted, performed with them and without, recorded,
# and exported from the take with the same bits.
# shellcheck source=tests/e2e/lib.sh
. "$SOURCE_DIR/tests/e2e/lib.sh"
head=$shared/data/heads/rpm_arkit.glb
if [ ! -f "$head" ]; then
    echo "SKIPPED: no $head (set MAROTTE_SHARED)"
    exit 77
fi
cp "$head" "$scratch/head.glb"
cd "$scratch" || exit 1
"$BUILD_DIR/marotte" rig new head.glb >/dev/null 2>new.err || fail "rig new: $(tail -c 200 new.err)"
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 0,/' head.rig.json >clay.rig.json
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 2,/' head.rig.json >wrong.rig.json
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 1,/' head.rig.json >said.rig.json

perform() { # NAME RIG ARGUMENTS...: NAME.pc2, and what was said in NAME.txt
    local name=$1 rig=$2
    shift 2
    timeout 120 "$BUILD_DIR/marotte" perform --face "$rig" --input "log:$demo" --map one_hand \
        --seconds 4 --export "$name.pc2" "$@" >"$name.txt" 2>"$name.err" ||
        fail "$name: $(tail -c 200 "$name.err")"
}
perform shaped head.rig.json --record show.marotte --export shaped.glb
perform clay clay.rig.json
perform said said.rig.json
cmp -s shaped.pc2 clay.pc2 && fail "shapes change nothing"
cmp -s shaped.pc2 said.pc2 || fail "\"shapes\": 1 is not what is meant where nothing is said"
for name in shaped clay; do
    [ "$(fact folds $name.txt)" = 0 ] || fail "$name: $(fact folds $name.txt) folds"
done
timeout 120 "$BUILD_DIR/marotte" take export show.marotte 1 --export again.pc2 >/dev/null 2>again.err ||
    fail "take export: $(tail -c 200 again.err)"
cmp -s shaped.pc2 again.pc2 || fail "a take of a head with shapes has other bits than what was performed"
refused 1 "shapes" "$BUILD_DIR/marotte" perform --face wrong.rig.json --input "log:$demo" --map one_hand --seconds 1
finish
