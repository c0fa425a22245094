#!/usr/bin/env bash
# demo_hand.csv is, byte for byte, what demo_hand writes; and it stays small.
set -u
fresh=$BUILD_DIR/tests/unit/demo_hand.csv
"$BUILD_DIR/plugins/demo_hand" "$fresh" || exit 1
cmp "$fresh" "$SOURCE_DIR/plugins/log/demo_hand.csv" || exit 1
size=$(wc -c <"$fresh")
[ "$size" -le 409600 ] || { echo "demo_hand.csv has $size bytes, more than 400 KB"; exit 1; }
