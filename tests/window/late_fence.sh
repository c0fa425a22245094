#!/usr/bin/env bash
# Mesa's software renderer frees a fence while one of its threads may still hold the lock in it; with that
# thread held up (late_fence.c) the stage crashed within seconds. It keeps fences until nobody can be in
# them (ui/draw/gl.c): nothing is freed while it is locked.
source "$(dirname "$0")/../e2e/lib.sh"
library=$BUILD_DIR/tests/window/liblate_fence.so
[ -e "$library" ] || { echo "SKIPPED: not with a sanitizer, which frees by itself"; exit 77; }
cd "$scratch" || exit 1
cp -r "$SOURCE_DIR/rigs/puppet" puppet # it may be painted
for seed in 5 6; do
    printf '%s\n' 'do output' "random $seed 2" >script.txt
    LD_PRELOAD=$library "$MAROTTE" stage --hidden --size 640x400 "show$seed.marotte" --face puppet/puppet.rig.json --settings "" \
        --input "log:$demo,loop=1" --script script.txt >said 2>&1
    code=$?
    grep -q 'OpenGL\|EGL' said && { echo "SKIPPED: nothing can be drawn here: $(head -n 1 said)"; exit 77; }
    [ $code -eq 0 ] || fail "seed $seed: exit $code: $(tail -n 3 said)"
    counts=$(grep '^held up' said)
    echo "seed $seed: $counts"
    [ "$counts" != "held up 0, freed while locked 0" ] || { echo "SKIPPED: drawn without llvmpipe's threads"; exit 77; }
    [[ $counts == *"freed while locked 0" ]] || fail "seed $seed: $counts"
done
finish
