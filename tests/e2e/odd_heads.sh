#!/usr/bin/env bash
# Heads that nobody would make on purpose, and that ended the program once: each is performed or refused, none by a signal.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1

# A sheet of 21 by 21 vertices, arched towards +z, with five contacts.
awk 'BEGIN {
    n = 21
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x)
        printf "v %g %g %g\n", x * 10 - 100, y * 10 - 100, 40 - ((x - 10) ^ 2 + (y - 10) ^ 2) / 5
    for (y = 0; y + 1 < n; ++y) for (x = 0; x + 1 < n; ++x) {
        a = y * n + x + 1
        printf "f %d %d %d %d\n", a, a + 1, a + n + 1, a + n
    }
}' >sheet.obj
rig() { # the greatest x that is rigid
    printf '{"marotte_rig": 1, "mesh": "sheet.obj", "unit": "mm", "bones": [{"name": "skull"}], "regions": [{"bone": "skull",
        "rigid": true, "select": {"box": {"low": [-200, -200, -200], "high": [%s, 200, 200]}}}], "contacts": [%s]}' "$1" \
        '{"name": "a", "vertex": 115}, {"name": "b", "vertex": 220}, {"name": "c", "vertex": 225},
         {"name": "d", "vertex": 230}, {"name": "e", "vertex": 330}' >sheet.rig.json
}

# Fingertips that hold what is rigid pull nothing: two of five, then all of them.
for rigid in 0 200; do
    rig "$rigid"
    for map in anchored unanchored; do
        "$MAROTTE" perform --face sheet.rig.json --input "log:$demo,end=3" --map "$map" --export "x.$map.glb" --export "x.$map.csv" \
            --export "x.$map.usda" --record "s.$rigid.$map.marotte" >said 2>stderr || fail "rigid up to x = $rigid, $map: exit $?: $(tail -n 2 stderr)"
        "$MAROTTE" take export "s.$rigid.$map.marotte" 1 --export y.glb >said 2>stderr ||
            fail "take export, rigid up to x = $rigid, $map: exit $?: $(tail -n 2 stderr)"
    done
    awk -v mm="$("$MAROTTE" perform --verbose --face sheet.rig.json --input "log:$demo,end=3" --map anchored | sed -nE 's/^range of motion +([0-9.]+).*/\1/p')" \
        -v rigid="$rigid" 'BEGIN { exit !(rigid > 0 ? mm == 0 : mm > 1) }' || fail "rigid up to x = $rigid: the wrong skin moves"
done
finish
