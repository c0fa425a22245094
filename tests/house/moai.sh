#!/usr/bin/env bash
# The committed Moai is, byte for byte, what its program generates.
set -u
program=$BUILD_DIR/rigs/moai/generate_moai
[ -x "$program" ] || { echo "$program is not built"; exit 1; }
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
"$program" "$scratch/moai.glb" || exit 1
cmp "$scratch/moai.glb" "$SOURCE_DIR/rigs/moai/moai.glb" && exit 0
echo "rigs/moai/moai.glb is not what rigs/moai generates: look at the new one, then ninja moai"
exit 1
