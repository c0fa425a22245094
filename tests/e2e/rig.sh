#!/usr/bin/env bash
# marotte rig: drafting, checking, showing and fitting, as a technical artist does it.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
puppet=$SOURCE_DIR/rigs/puppet/puppet

# The rigs that come with the program are right.
for name in moai puppet; do
    "$MAROTTE" rig check "$SOURCE_DIR/rigs/$name/$name.rig.json" >"$name.txt" ||
        fail "rig check $name: $(head -3 "$name.txt")"
    grep -q ': 0 errors, ' "$name.txt" || fail "$name: $(tail -1 "$name.txt")"
    grep '^warning' "$name.txt" && fail "$name has warnings"
    grep -q '^note     \$.poses: poses hold all 27 contacts' "$name.txt" || fail "$name: what poses do"
done

# A new head: drafted, checked, and it says what to look at.
cp "$puppet.glb" new.glb
"$MAROTTE" rig new new.glb >drafted.txt || fail "rig new"
grep -q '^wrote    new.rig.json$' drafted.txt || fail "what was written: $(head -1 drafted.txt)"
[ "$(grep -c '^confirm  ' drafted.txt)" -ge 10 ] || fail "little to confirm"
"$MAROTTE" rig check new.rig.json --json >checked.json || fail "the draft has errors"
grep -q '"errors": 0' checked.json || fail "the draft's errors as JSON"
refused 1 "new.rig.json: exists already" "$MAROTTE" rig new new.glb
"$MAROTTE" rig new new.glb --force >/dev/null || fail "rig new --force"

# The picture.
if "$MAROTTE" rig show new.rig.json --out rig.png >shown.txt 2>show_error.txt; then
    [ "$(head -c 8 rig.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || fail "no PNG"
    grep -q '^mouth: rims of 37 and 37 vertices, 113.0 mm wide, 0.1 mm open at rest, sealed from the corners$' shown.txt ||
        fail "what is said of the mouth: $(cat shown.txt)"
    "$MAROTTE" rig show new.rig.json --out one.png --yaw 20 --pitch 5 >/dev/null || fail "--yaw"
    [ "$(stat -c %s rig.png)" -gt "$(stat -c %s one.png)" ] || fail "three views and one"
elif grep -qi 'egl\|opengl\|graphics' show_error.txt; then
    echo "no picture here: $(cat show_error.txt)"
else
    fail "rig show: $(cat show_error.txt)"
fi

# The poses: a line each; a portrait each where pictures can be made.
"$MAROTTE" rig show "$puppet.rig.json" --poses >poses.txt || fail "rig show --poses"
"$MAROTTE" rig show puppet --poses --only joy >named.txt || fail "rig show takes no rig by its name"
grep -q '^joy' named.txt || fail "rig show puppet: $(cat named.txt)"
"$MAROTTE" rig check moai >/dev/null || fail "rig check takes no rig by its name"
[ "$(head -4 poses.txt | cut -d' ' -f1 | tr '\n' ' ')" = "joy sadness anger surprise " ] ||
    fail "the puppet's poses: $(cat poses.txt)"
[ "$(grep -cE 'least determinant  [01]\.[0-9]+   penetration 0\.00 mm   furthest [0-9.]+ mm' poses.txt)" -eq 80 ] ||
    fail "what is measured of poses: $(cat poses.txt)"
"$MAROTTE" rig show "$puppet.rig.json" --poses --only jawOpen,joy >only.txt || fail "rig show --only"
[ "$(cut -d' ' -f1 only.txt | tr '\n' ' ')" = "jawOpen joy " ] || fail "--only: $(cat only.txt)"
refused 1 'has no "sorrow"' "$MAROTTE" rig show "$puppet.rig.json" --poses --only joy,sorrow
grep -q FOLDS poses.txt && fail "a pose of the puppet folds"
if [ -e rig.png ]; then
    "$MAROTTE" rig show "$puppet.rig.json" --poses --only joy,surprise,anger,smug --out poses.png >shown.txt || fail "portraits"
    [ "$(tail -1 shown.txt)" = "wrote poses.png: 4 poses" ] || fail "$(tail -1 shown.txt)"
    [ "$(od -An -tu1 -j16 -N8 poses.png | tr -s ' ')" = " 0 0 6 64 0 0 2 116" ] ||
        fail "the portraits are not 1600 by 628"
    "$MAROTTE" rig show "$puppet.rig.json" --poses --only joy,surprise,anger,smug --yaw -20 --out other.png >/dev/null || fail "--yaw"
    cmp -s poses.png other.png && fail "--yaw does not turn the portraits"
fi
printf '{"marotte_rig": 1, "mesh": "new.glb", "include": "new.rig.json", "poses": [%s]}' \
    '{"name": "torn", "pulls": {"mouth.corner.l": [-90, 60, 0]}}' >torn.rig.json
"$MAROTTE" rig show torn.rig.json --poses >torn.txt || fail "a pose that folds cannot be shown"
grep -qE '^torn +least determinant +-[0-9.]+ .* FOLDS$' torn.txt || fail "no fold: $(cat torn.txt)"
grep -q '"name": *"mouthSmileLeft"' new.rig.json || fail "the draft has no pose of the puppet's"
printf '{"marotte_rig": 1, "mesh": "new.glb", "bones": [{"name": "skull"}]}' >bare.rig.json
refused 1 'bare.rig.json: the rig has no poses' "$MAROTTE" rig show bare.rig.json --poses --out out/p.png
printf x >no
refused 1 'no: cannot create this folder' "$MAROTTE" rig show torn.rig.json --poses --only torn --out no/such/p.png

# Errors make the exit code.
bad() { # words file text
    printf '%s' "$3" >"$2"
    if "$MAROTTE" rig check "$2" >out.txt 2>&1; then
        fail "$2 passes"
    elif ! grep -qF -- "$1" out.txt; then
        fail "\"$1\" is not said: $(cat out.txt)"
    fi
}
mesh='"marotte_rig": 1, "mesh": "new.glb"'
jaw='{"name": "jaw", "hinge": {"left": [60,0,0], "right": [-60,0,0]}}'
bones="\"bones\": [{\"name\": \"skull\"}, $jaw]"
skull='{"bone": "skull", "rigid": true, "select": {"group": "teeth_upper"}}'
bad 'm.rig.json: $.mesh: gone.glb: No such file' m.rig.json '{"marotte_rig": 1, "mesh": "gone.glb"}'
bad '$.bones[1]: no vertex belongs to the bone "jaw"' b.rig.json \
    "{$mesh, $bones, \"regions\": [$skull]}"
bad '$.regions[1]: overlaps $.regions[0]: vertex' o.rig.json \
    "{$mesh, $bones, \"regions\": [$skull, {\"bone\": \"jaw\", \"rigid\": true, \"select\": {\"group\": \"teeth*\"}}]}"
bad '$.contact_sets.s[0]: the rig has no contact "cheek"' c.rig.json "{$mesh, \"contact_sets\": {\"s\": [\"cheek\"]}}"
bad '$.bones[0].hinge: left and right are only 0 mm apart' h.rig.json \
    "{$mesh, \"bones\": [{\"name\": \"jaw\", \"hinge\": {\"left\": [1,1,1], \"right\": [1,1,1]}}]}"
bad '$.bones[0].open_deg: [32, 0] is reversed' r.rig.json \
    "{$mesh, \"bones\": [{\"name\": \"jaw\", \"hinge\": {\"left\": [60,0,0], \"right\": [-60,0,0]}, \"open_deg\": [32, 0]}]}"
bad '$.mesh_vertices: the rig was made for a mesh of 7 vertices, but this one has 20428' v.rig.json \
    "{$mesh, \"mesh_vertices\": 7}"
printf '{"marotte_rig": 1, "include": "y.rig.json"}' >x.rig.json
bad 'y.rig.json includes x.rig.json includes y.rig.json' y.rig.json \
    "{$mesh, \"include\": \"x.rig.json\"}"
bad 'line 1, column' j.rig.json '{"marotte_rig": 1,, }'

# Wrong usage.
refused 2 "choose check, show, new, fit or teeth" "$MAROTTE" rig
refused 2 'there is no command "rig paint"' "$MAROTTE" rig paint
refused 2 "check needs one rig file" "$MAROTTE" rig check
refused 2 "show needs a rig file" "$MAROTTE" rig show new.rig.json
refused 2 "--yaw \"x\" is not a number" "$MAROTTE" rig show new.rig.json --out a.png --yaw x
refused 2 "show needs a rig file" "$MAROTTE" rig show --poses
refused 2 "--out needs a value" "$MAROTTE" rig show new.rig.json --poses --out
refused 2 "fit needs a rig and a mesh" "$MAROTTE" rig fit new.rig.json
# A head that has a mouth keeps it; what a rig says of a cut is checked.
"$MAROTTE" rig new new.glb --cut-mouth --force >cut.txt || fail "rig new --cut-mouth"
grep -q "nothing was cut" cut.txt || fail "a mouth was cut into a head that has one"
grep -q cut_mouth new.rig.json && fail "a cut is in the rig all the same"
sed 's/"marotte_rig": 1,/"marotte_rig": 1, "cut_mouth": [1, 2, 3, 400],/' new.rig.json >cut.rig.json
refused 1 'cut.rig.json: $.cut_mouth: vertices 1 and 2 are not joined by an edge of two triangles' \
    "$MAROTTE" rig check cut.rig.json
refused 1 "this is a mesh, not a rig; marotte rig new" "$MAROTTE" rig check new.glb
refused 1 "has no morph targets" "$MAROTTE" rig fit new.rig.json new.glb

# A mesh in another folder is a matter for the person, and for the folders that are allowed.
mkdir far
cp "$moai" head.glb
"$MAROTTE" rig new head.glb --out far/far.rig.json >far.txt || fail "a mesh in another folder"
grep -q '^confirm  $.mesh: .*is not in the folder' far.txt || fail "a mesh elsewhere is no matter"
refused 1 'far.rig.json: $.mesh: ' "$MAROTTE" rig check far/far.rig.json
MAROTTE_FILE_FOLDERS=$scratch "$MAROTTE" rig check far/far.rig.json >/dev/null || fail "allowed folder"

# A face made with the rig is found again.
if [ -e "$shared/data/faces/ict_face.glb" ]; then
    cp "$shared/data/faces/ict_face.glb" .
    "$MAROTTE" rig new ict_face.glb --out ict.rig.json >/dev/null || fail "ict"
    "$MAROTTE" rig fit ict.rig.json "$shared/data/faces/ict_face.glb" --json --out fitted.glb \
        --save-poses posed.rig.json >fit.json || fail "rig fit"
    [ "$(grep -c '"relative_residual"' fit.json)" -eq 14 ] || fail "not 14 targets"
    "$MAROTTE" rig fit posed.rig.json fitted.glb >again.txt || fail "fit of what was fitted"
    residual=$(sed -nE 's/^mean, or worst +([0-9.]+).*/\1/p' again.txt)
    awk "BEGIN { exit !($residual < 0.05) }" || fail "fitted faces are missed by $residual"
    refused 1 'ict.rig.json: $.contact_sets has no "few"' "$MAROTTE" rig fit ict.rig.json \
        "$shared/data/faces/ict_face.glb" --contacts few
    [ "$(grep -c '"name": "jawOpen", "dofs"' posed.rig.json)" -eq 1 ] || fail "no pose was saved"
else
    echo "no face to fit in $shared"
fi

# A head on which no face is seen pulled like clay: hands can pull it.
if [ -e "$shared/data/heads/cryptovoxels.vrm" ]; then
    cp "$shared/data/heads/cryptovoxels.vrm" .
    "$MAROTTE" rig new cryptovoxels.vrm >egg.txt || fail "a head without a face"
    grep -q 'pulled like clay' egg.txt || fail "what is done without a face is not said"
    "$MAROTTE" perform --verbose --face cryptovoxels.rig.json --input "log:$demo,end=6" --map anchored >facts.txt || fail "clay"
    awk -v mm="$(fact 'range of motion' facts.txt)" 'BEGIN { exit !(mm > 3) }' || fail "the clay cannot be pulled"
fi
finish
