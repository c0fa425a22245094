#!/usr/bin/env bash
# The committed Moai is, byte for byte, what its program generates; the generators refuse nonsense.
set -u
moai=$BUILD_DIR/rigs/moai/generate_moai
plane=$BUILD_DIR/rigs/plane/generate_plane
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
failed=0
complain() { echo "$1"; failed=1; }

# exits STATUS COMMAND...: the command ends with that status, says why, and leaves no file behind.
exits() {
    local expected=$1
    shift
    "$@" >"$scratch/out" 2>"$scratch/err"
    local status=$?
    [ $status -eq "$expected" ] || complain "$*: exit $status instead of $expected"
    [ -s "$scratch/err" ] || complain "$*: says nothing"
}

for program in "$moai" "$plane"; do
    [ -x "$program" ] || { echo "$program is not built"; exit 1; }
done

exits 2 "$moai"
exits 2 "$plane" 2048
exits 2 "$plane" 2047 "$scratch/plane.ply"
touch "$scratch/file" # and not a folder
exits 1 "$plane" 2048 "$scratch/file/plane.ply"
exits 1 "$moai" "$scratch/file/moai.glb"
[ ! -e "$scratch/plane.ply" ] || complain "a plane of 2047 triangles was written"

if ! "$moai" "$scratch/moai.glb"; then
    complain "generate_moai failed"
elif ! cmp "$scratch/moai.glb" "$SOURCE_DIR/rigs/moai/moai.glb"; then
    complain "rigs/moai/moai.glb is not what rigs/moai generates: look at the new one, then ninja moai"
fi
exit $failed
