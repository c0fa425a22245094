#!/usr/bin/env bash
# `marotte plugin check` finds nothing in the plugins that come with marotte, so often as
# MAROTTE_CHECK_REPEAT says (once), each time with another seed. Inputs without their device are judged
# on what can be judged.
source "$(dirname "$0")/lib.sh"
unset MAROTTE_CHECK_DIVISOR
repeat=${MAROTTE_CHECK_REPEAT:-1}
count=0
for library in "$BUILD_DIR"/plugins/*.so "$BUILD_DIR"/tests/plugin/*_template.so; do
    [ -e "$library" ] || continue
    name=$(basename "$library" .so)
    addresses=()
    [ "$name" = log ] && addresses=(--input "$SOURCE_DIR/plugins/log/demo_hand.csv")
    [ "$name" = osc ] && addresses=(--input "127.0.0.1:$((30000 + $$ % 20000))" --output 127.0.0.1:9)
    [ "$name" = phone ] && addresses=(--input "$((30000 + $$ % 20000))")
    [ "$name" = midi ] && { mkfifo "$scratch/pipe"; addresses=(--input "$scratch/pipe"); }
    "$MAROTTE" plugin check "$library" --seed $((RANDOM * 100)) --repeat "$repeat" "${addresses[@]}" \
        >"$scratch/said" || { fail "$name"; cat "$scratch/said"; }
    tail -1 "$scratch/said"
    count=$((count + 1))
done
# A walk that the paper's manner followed further than a pull may reach.
"$MAROTTE" plugin check "$BUILD_DIR/plugins/anchored.so" --seed 2769600 >"$scratch/said" ||
    { fail "anchored, far"; cat "$scratch/said"; }
# A reset after an undo of a learned hand pose.
"$MAROTTE" plugin check "$BUILD_DIR/plugins/one_hand.so" --seed 2206700 >"$scratch/said" ||
    { fail "one_hand, reset"; cat "$scratch/said"; }
[ $count -ge 7 ] || fail "only $count plugins were found"
finish
