#!/usr/bin/env bash
# Whatever is wrong with what it is given: one clear line that names the thing, exit 1 (2 for wrong
# usage), and nothing half-written.
source "$(dirname "$0")/lib.sh"
out=$scratch/out/a.glb
in=$scratch/in
mkdir "$in"

perform() { # face input map [more]
    local face=$1 input=$2 map=$3
    shift 3
    set -- perform --face "$face" --input "$input" --map "$map" --export "$out" "$@"
    command_line=("$MAROTTE" "$@")
}
bad_face() { # words face
    perform "$2" "log:$demo" anchored
    refused 1 "$1" "${command_line[@]}"
}
bad_input() {
    perform "$moai" "$2" anchored
    refused 1 "$1" "${command_line[@]}"
}
bad_map() {
    perform "$moai" "log:$demo" "$2"
    refused 1 "$1" "${command_line[@]}"
}

# Faces.
bad_face "$in/none.glb: No such file" "$in/none.glb"
bad_face "$in: is a directory" "$in"
: >"$in/empty.obj"
bad_face "$in/empty.obj: the file is empty" "$in/empty.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >"$in/range.obj"
bad_face "$in/range.obj: line 4" "$in/range.obj"
printf 'v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n' >"$in/nan.obj"
bad_face "$in/nan.obj: line 2" "$in/nan.obj"
printf '# nothing\n' >"$in/zero.obj"
bad_face "$in/zero.obj" "$in/zero.obj"
printf 'OFF\n0 0 0\n' >"$in/zero.off"
bad_face "$in/zero.off" "$in/zero.off"
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n' >"$in/range.off"
bad_face "$in/range.off" "$in/range.off"
printf 'ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\n' >"$in/huge.ply"
bad_face "$in/huge.ply" "$in/huge.ply"
printf 'v 1e30 0 0\nv 0 1e30 0\nv 0 0 1e30\nf 1 2 3\n' >"$in/far.obj"
bad_face "$in/far.obj: vertex 0" "$in/far.obj"
printf 'hello' >"$in/a.xyz"
bad_face "$in/a.xyz" "$in/a.xyz"
head -c 4096 /dev/urandom >"$in/random.stl"
bad_face "$in/random.stl" "$in/random.stl"
size=$(stat -c %s "$moai")
for i in $(seq 1 "$([ -n "${MAROTTE_TEST_LONG:-}" ] && echo 1 || echo 4)" 63); do
    head -c $((size * i / 64)) "$moai" >"$in/cut.glb"
    bad_face "$in/cut.glb" "$in/cut.glb"
done

# Inputs.
bad_input "$in/none.csv" "log:$in/none.csv"
bad_input "$in" "log:$in"
: >"$in/empty.csv"
bad_input "$in/empty.csv" "log:$in/empty.csv"
printf 'a letter to a friend\nwith two lines\n' >"$in/foreign.txt"
bad_input "$in/foreign.txt" "log:$in/foreign.txt"
head -c 4096 /dev/urandom >"$in/random.csv"
bad_input "$in/random.csv" "log:$in/random.csv"
# Time that runs backwards all the way.
{ grep -m1 '^time' "$demo"; grep -E '^[0-9]' "$demo" | tac; } >"$in/backwards.csv"
bad_input "$in/backwards.csv" "log:$in/backwards.csv"
bad_input 'no input plugin "waldo"' "waldo:x"
bad_input 'no parameter "tempo"' "log:$demo,tempo=2"
bad_input 'speed' "log:$demo,speed=fast"

# Mappings.
bad_map 'no mapping plugin "waldo"' waldo
bad_map './waldo.so: cannot open shared object file' waldo.so
bad_map 'is a button' gesture,forget=1
bad_map 'ABI 7, but this program uses ABI 1' "$BUILD_DIR/tests/plugin/abi.so"
bad_map 'marotte_plugins' "$BUILD_DIR/tests/plugin/symbol.so"
bad_map 'no licence for this machine' "$BUILD_DIR/tests/plugin/create.so"
bad_map 'org.example.broken gave a control vector that is not finite' "$BUILD_DIR/tests/plugin/nan.so"
bad_map 'org.example.broken gave a control vector that is not finite or leads out of reach' \
    "$BUILD_DIR/tests/plugin/reach.so"
bad_map 'org.example.broken gave more vectors than are allowed' "$BUILD_DIR/tests/plugin/many.so"
bad_map 'org.example.broken gave a radius' "$BUILD_DIR/tests/plugin/radius.so"
bad_map 'org.example.broken returned -2' "$BUILD_DIR/tests/plugin/result.so"
bad_map "$in/none.so" "$in/none.so"
bad_map "$in/range.obj" "$in/range.obj"
mkfifo "$in/pipe.so"
bad_map "$in/pipe.so: is not a regular file" "$in/pipe.so"
library=$BUILD_DIR/tests/plugin/nan.so
size=0 # of what is loaded: with what debuggers read behind it a file that is cut there is whole
while read -r _ offset _ _ length _; do
    size=$((offset + length > size ? offset + length : size))
done < <(readelf -lW "$library" | grep '^ *LOAD')
for i in $(seq 1 8); do
    head -c $((size * i / 16)) "$library" >"$in/cut.so"
    bad_map "$in/cut.so: " "$in/cut.so"
done
bad_map 'radius=0 is outside' anchored,radius=0
bad_map 'radius=-3 is outside' anchored,radius=-3
bad_map 'radius="nan" is not a number' anchored,radius=nan

# Exports.
perform "$moai" "log:$demo" anchored
printf x >"$scratch/none" # a file where a folder is wanted
refused 1 "$scratch/none: cannot create this folder: Not a directory" "${command_line[@]}" --export "$scratch/none/b.glb"
mkdir -p "$scratch/folder.glb"
refused 1 "is a directory" "${command_line[@]}" --export "$scratch/folder.glb"
mkdir -p "$scratch/folder.usda" "$scratch/folder.bvh" "$scratch/folder.points.usda"
for ending in usda points.usda bvh; do
    refused 1 "is a directory" "${command_line[@]}" --export "$scratch/folder.$ending"
    refused 1 "$scratch/none" "${command_line[@]}" --export "$scratch/none/b.$ending"
done
perform "$moai" "log:$demo,end=1" anchored
if [ -w /dev/full ]; then
    "$MAROTTE" plugin list >/dev/full 2>"$scratch/stderr"
    [ $? -eq 1 ] || fail "a full disk behind stdout is not a failure"
fi
# A disk that takes no more: a limit on the size of files stands in for it, first for the temporary
# file of the frames, then for the exports.
full_disk() { # KiB name map
    rm -rf "$scratch/out"
    mkdir "$scratch/out"
    (
        ulimit -f "$1"
        timeout 60 "$MAROTTE" perform --face "$moai" --input "log:$demo,end=5" --map "$3" \
            --export "$scratch/out/$2" >/dev/null 2>"$scratch/stderr"
    )
    local got=$?
    [ "$got" -eq 1 ] || fail "exit $got instead of 1: $2 over the limit of $1 KiB"
    grep -q 'File too large' "$scratch/stderr" || fail "no reason: $(cat "$scratch/stderr")"
    [ -z "$(ls -A "$scratch/out")" ] || fail "left behind: $(ls -A "$scratch/out")"
}
full_disk 2 a.glb unanchored
full_disk 2 a.png anchored
full_disk 400 a.glb anchored
full_disk 400 a.pc2 anchored
full_disk 400 a.usda anchored
full_disk 400 a.points.usda unanchored
full_disk 2 a.bvh anchored
full_disk 400 a.mdd anchored
grep -qF "$scratch/out/a.mdd" "$scratch/stderr" || fail "not the export failed: $(cat "$scratch/stderr")"

# Wrong usage.
usage() {
    local words=$1
    shift
    refused 2 "$words" "$MAROTTE" "$@"
}
usage 'no command or file "waltz"' waltz
usage '--face is missing' perform
usage '--input is missing' perform --face "$moai"
usage '--map is missing' perform --face "$moai" --input "log:$demo"
usage 'must end in' perform --face "$moai" --export "$scratch/out/a.fbx"
usage '--fps "0"' perform --fps 0
usage '--fps "nan"' perform --fps nan
usage 'no option "--fsp"' perform --fsp 1
usage 'needs a value' perform --face
usage 'unexpected argument' perform surplus
usage 'choose list, new or check' plugin
usage 'there is no command "plugin lits". Did you mean "list"?' plugin lits

# Settings: what the person names and is no settings file stays as it is, and the stage does not start.
stage_with() { # words path
    refused 1 "$1" "$MAROTTE" stage "$scratch/out/a.marotte" --hidden --seconds 0.1 --size 640x400 --settings "$2"
}
mkdir "$in/years"
echo "My thesis." >"$in/thesis.txt"
echo "Its draft." >"$in/thesis.txt.damaged"
echo '{"name": "a package"}' >"$in/years/package.json"
ln -s thesis.txt "$in/link.json"
ln -s nowhere "$in/nowhere.json"
before=$(cd "$in" && ls -lR thesis* years link.json nowhere.json && cat thesis* years/*)
stage_with "$in/years: is a directory" "$in/years"
stage_with "$in/thesis.txt: is not a settings file of marotte (line 1" "$in/thesis.txt"
stage_with "$in/years/package.json: is not a settings file of marotte" "$in/years/package.json"
stage_with "$in/link.json: is not a settings file" "$in/link.json"
stage_with "$in/nowhere.json: No such file" "$in/nowhere.json"
[ "$before" = "$(cd "$in" && ls -lR thesis* years link.json nowhere.json && cat thesis* years/*)" ] ||
    fail "a file that is no settings file was changed: $(ls -lR "$in")"

# Names that steer a terminal: printed as '?', also in JSON; commands to copy name the same file.
is_clean() { # what file
    ! LC_ALL=C grep -qP '\x1b|\xff' "$2" || fail "$1 prints what steers a terminal"
}
folder=$scratch/$'steer\e[31m\xff it'
mkdir "$folder"
cp "$moai" "$folder/head.glb"
"$MAROTTE" rig new "$folder/head.glb" >"$scratch/said" 2>&1 || fail "rig new: $(cat "$scratch/said")"
is_clean "rig new" "$scratch/said"
next=$(sed -n 's/^next     marotte rig check //p' "$scratch/said")
eval "\"\$MAROTTE\" rig check $next --json" >"$scratch/said" 2>"$scratch/errors"
[ $? -le 1 ] && grep -q '"file"' "$scratch/said" || fail "the command to copy does not find its file: $next: $(cat "$scratch/errors")"
is_clean "rig check --json" "$scratch/said"
"$MAROTTE" perform --face "$moai" --input "log:$demo" --map anchored --record "$folder/a.marotte" >/dev/null 2>"$scratch/errors" || fail "$(cat "$scratch/errors")"
dd if=/dev/zero of="$folder/a.marotte" bs=1 seek=40000 count=4000 conv=notrunc 2>/dev/null
refused 1 "it/none.marotte: cannot be opened: No such file" "$MAROTTE" take recover "$folder/none.marotte" --out "$folder/b.marotte"
refused 1 "it: is a folder or a device" "$MAROTTE" take recover "$folder" --out "$folder/b.marotte"
for how in "" --json; do
    "$MAROTTE" take check "$folder/a.marotte" $how >"$scratch/said" 2>&1
    is_clean "take check $how" "$scratch/said"
done
grep -q 'marotte take recover' "$scratch/said" || fail "take check does not say how the rest is saved: $(cat "$scratch/said")"
finish
