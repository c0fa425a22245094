#!/usr/bin/env bash
# The Khronos validator finds neither errors nor warnings in what is exported, and does find one in
# a file that was damaged on purpose.
set -u
command -v node >/dev/null || { echo "SKIPPED: node is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$BUILD_DIR/tests/e2e/gltf_samples" "$folder" || exit 1
node "$SOURCE_DIR/tests/e2e/validate.mjs" "$folder"/*.glb
result=$?
[ $result -eq 77 ] && exit 77
[ $result -eq 0 ] || { echo "FAILED: the validator has objections"; exit 1; }

# "POSITION" is required; the same number of bytes keeps the file's structure.
sed 's/"POSITION"/"_OSITION"/g' "$folder/plain.glb" >"$folder/damaged.glb"
node "$SOURCE_DIR/tests/e2e/validate.mjs" "$folder/damaged.glb" >"$folder/objections"
[ $? -eq 1 ] || { echo "FAILED: a damaged file passed"; cat "$folder/objections"; exit 1; }
echo "a damaged file is refused"
