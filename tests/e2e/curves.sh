#!/usr/bin/env bash
# Curves that people can edit: glTF has them as targets with names; a table of them performs the same face again,
# and what a person changes in it changes the face.
source "$(dirname "$0")/lib.sh"

# The greatest difference of two point caches, mm.
apart_mm() {
    paste <(tail -c +33 "$1" | od -An -v -t f4 -w4) <(tail -c +33 "$2" | od -An -v -t f4 -w4) |
        awk 'NF != 2 { print "of another length"; exit } { d = $1 - $2; d = d < 0 ? -d : d; if (d > most) most = d }
            END { printf "%.6f\n", most }'
}

again() { # face mapping seconds
    local name=$2 table=$scratch/$2.csv
    "$MAROTTE" perform --verbose --face "$1" --input "log:$demo,start=12,end=$((12 + $3))" --map "$2" --fps 12 \
        --export "$table" --export "$scratch/$name.pc2" --export "$scratch/$name.glb" >"$scratch/$name.txt" 2>/dev/null ||
        fail "perform $name"
    "$MAROTTE" perform --verbose --face "$1" --curves "$table" --export "$scratch/$name.again.pc2" \
        --export "$scratch/$name.again.csv" >"$scratch/said" 2>"$scratch/stderr" ||
        fail "$name: --curves: $(cat "$scratch/stderr")"
    [ -s "$scratch/stderr" ] && fail "$name: $(cat "$scratch/stderr")"
    local apart
    apart=$(apart_mm "$scratch/$name.pc2" "$scratch/$name.again.pc2")
    echo "$name: $(wc -l <"$table") lines, $apart mm apart, moves $(fact 'range of motion' "$scratch/$name.txt") mm"
    awk -v mm="$apart" 'BEGIN { exit !(mm ~ /^[0-9.]+$/ && mm < 0.01) }' || fail "$name: the table shows it $apart mm off"
    awk -v mm="$(fact 'range of motion' "$scratch/$name.txt")" 'BEGIN { exit !(mm > 5) }' || fail "$name: it hardly moves"
}
again "$puppet" one_hand 4
again "${moai%.glb}.rig.json" anchored 4
again "$moai" anchored 4

# What glTF calls them, in every frame.
targets=$(strings -n 8 "$scratch/one_hand.glb" | grep -o '"targetNames":\[[^]]*\]' | head -n 1)
for name in 'jaw.open' 'skull.nod -' 'mouth.corner.l out' 'mouth.corner.r up' 'remainder 1'; do
    grep -qF "\"$name\"" <<<"$targets" || fail "no target is called $name: $targets"
done
grep -q 'component\|turn_x' <<<"$targets" && fail "targets have names of the engine: $targets"
awk -v most="$(fact 'greatest error' "$scratch/one_hand.txt")" 'BEGIN { exit !(most < 0.04) }' || fail "inexact"
grep -q '^remainder .* mm at most' "$scratch/one_hand.txt" || fail "the remainder is not told"

# Its bones are nodes that turn, and its files are what the validator knows.
grep -aq '"name":"bone jaw"' "$scratch/one_hand.glb" || fail "no node for the jaw"
if [ -e "$SOURCE_DIR/tests/e2e/node_modules/gltf-validator" ]; then
    odd="$scratch/ä b \"q\""
    "$MAROTTE" perform --face "$puppet" --input "log:$demo,start=12,end=13" --map one_hand --bare \
        --export "$odd.glb" --export "$odd.vrma" >/dev/null 2>"$scratch/stderr" || fail "odd names: $(cat "$scratch/stderr")"
    node "$SOURCE_DIR/tests/e2e/validate.mjs" "$scratch/one_hand.glb" "$odd.glb" "$odd.vrma" >"$scratch/said" ||
        fail "the validator: $(grep -m 5 'error\|warning' "$scratch/said")"
else
    echo "SKIPPED: the validator is not installed (bash tests/e2e/setup_packages.sh)"
fi
"$MAROTTE" perform --face "$puppet" --input "log:$demo,end=1" --map one_hand --export "$scratch/no.vrm" \
    >/dev/null 2>"$scratch/stderr" && fail "a .vrm of a face that is none"
grep -q 'the face is not from a .vrm file' "$scratch/stderr" || fail "a .vrm is refused without a reason: $(cat "$scratch/stderr")"

# A table by hand: a column, two rows.
printf 'jaw.open,note\n0,shut\n0.3,open\n' >"$scratch/mine.csv"
"$MAROTTE" perform --face "$puppet" --curves "$scratch/mine.csv" --fps 25 --export "$scratch/mine.glb" --json \
    >"$scratch/mine.json" 2>"$scratch/stderr" || fail "a table by hand: $(cat "$scratch/stderr")"
grep -q '^note: 1 columns of .*mine.csv do not match anything' "$scratch/stderr" || fail "a note is not told: $(cat "$scratch/stderr")"
grep -q '"frames": 2' "$scratch/mine.json" || fail "two rows are not two frames"
awk -F'[:,]' '/range_of_motion_mm/ { exit !($2 > 5) }' "$scratch/mine.json" || fail "the jaw does not open"

# Bad tables name the line, and what to do.
refuse() { # reason text...
    printf "${2//\\n/\\n}" >"$scratch/bad.csv"
    "$MAROTTE" perform --face "$puppet" --curves "$scratch/bad.csv" --export "$scratch/bad.glb" >/dev/null 2>"$scratch/stderr" &&
        fail "a bad table is performed: $1"
    grep -qF -- "$1" "$scratch/stderr" || fail "expected \"$1\": $(cat "$scratch/stderr")"
    [ -e "$scratch/bad.glb" ] && fail "a bad table leaves a file: $1"
}
refuse 'bad.csv:3: jaw.open is not a number' 'jaw.open\n0\nwide\n'
refuse 'bad.csv:3: 1 cells' 'jaw.open,jaw.lateral\n0,0\n1\n'
refuse 'for example "skull.turn"' 'Jaw Open\n0\n'
refuse 'bad.csv:4: time_s does not increase' 'time_s,jaw.open\n0,0\n0.1,0\n0.1,0\n'
"$MAROTTE" perform --face "$puppet" --curves x.csv --map one_hand >/dev/null 2>"$scratch/stderr"
[ $? -eq 2 ] || fail "--curves with --map"
finish
