#!/usr/bin/env bash
# .usda is read back by a parser of the tests and by a USD library that is not ours, and shows at ten times what the
# point cache has: blend shapes within the tolerance, points to a thousandth of a millimetre.
source "$(dirname "$0")/lib.sh"
command -v node >/dev/null || { echo "SKIPPED: node is not installed"; exit 77; }
read_usda=$SOURCE_DIR/tests/e2e/usda.mjs

shows() { # name ARGS...: both forms
    local name=$1 most form off
    shift
    "$MAROTTE" perform --verbose "$@" --export "$scratch/$name.usda" --export "$scratch/$name.points.usda" \
        --export "$scratch/$name.pc2" >"$scratch/told" 2>"$scratch/stderr" ||
        { fail "$name: $(cat "$scratch/stderr")"; return; }
    most=$(fact tolerance "$scratch/told") # of the shapes, and what writing them in decimals takes
    for form in usda points.usda; do
        node "$read_usda" "$scratch/$name.$form" "$scratch/$name.pc2" "$cache_mm" >"$scratch/$name.$form.said" ||
            { fail "$name.$form: $(tail -n 1 "$scratch/$name.$form.said")"; continue; }
        off=$(sed -nE 's/^off by ([0-9.]+) mm.*/\1/p' "$scratch/$name.$form.said")
        awk -v off="$off" -v most="$([ $form = usda ] && echo "$most" || echo 0)" \
            'BEGIN { exit !(off != "" && off <= most + 0.001) }' || fail "$name.$form: $off mm off"
        echo "$name.$form: $(grep -v ^called "$scratch/$name.$form.said" | tr '\n' ';')"
    done
}
cache_mm=1
hands=(--input "log:$demo,end=3" --fps 12)
shows moai --face "${moai%.glb}.rig.json" --map anchored "${hands[@]}"
shows clay --face "$moai" --map unanchored "${hands[@]}"
cache_mm=10 # the point cache is in that unit too
shows cm --face "$moai" --map unanchored "${hands[@]}" --export-unit cm
cache_mm=1
grep -q ' 0.01 m$' "$scratch/cm.usda.said" || fail "--export-unit cm: $(cat "$scratch/cm.usda.said")"
grep -q ' 0.001 m$' "$scratch/moai.usda.said" || fail "the unit is not mm: $(cat "$scratch/moai.usda.said")"

# Names in other letters, with what would end a string, twice, and none; no normals.
{
    printf 'v %s\n' '-40 -60 0' '40 -60 0' '40 60 0' '-40 60 0' '0 0 50'
    printf 'g %s\nusemtl %s\nf %s\n' 'лицо' кожа '1 2 5' 'a "b\c' кожа '2 3 5' 1st кожа '3 4 5' 'лицо' зубы '4 1 5'
} >"$scratch/names.obj"
shows names --face "$scratch/names.obj" --map unanchored "${hands[@]}" --unit mm
for called in '____ is лицо' '_____2 is лицо' 'a__b_c is a "b\c' '_1st is 1st'; do
    grep -qF "/$called" "$scratch/names.usda.said" || fail "not there: $called: $(cat "$scratch/names.usda.said")"
done
! grep -q 'normal3f' "$scratch/names.usda" || fail "normals that the source does not have"

node "$SOURCE_DIR/tests/e2e/usd_library.mjs" "$scratch"/*.usda
case $? in 0 | 77) ;; *) fail "the USD library has objections" ;; esac
sed '0,/\[/s//(/' "$scratch/clay.usda" >"$scratch/broken.usda"
if node "$read_usda" "$scratch/broken.usda" "$scratch/clay.pc2" 1 >/dev/null; then fail "a broken file was read"; fi

finish
