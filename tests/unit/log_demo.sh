#!/usr/bin/env bash
# The demo recordings are, byte for byte, what demo_hand and demo_face write; they stay small; and the
# left hand has a part of its own.
set -u
demo() { # hand, file
    local fresh=$BUILD_DIR/tests/unit/$2 size
    "$BUILD_DIR/plugins/demo_hand" "$1" "$fresh" || exit 1
    cmp "$fresh" "$SOURCE_DIR/plugins/log/$2" || exit 1
    size=$(wc -c <"$fresh")
    [ "$size" -le 409600 ] || { echo "$2 has $size bytes, more than 400 KB"; exit 1; }
}
demo right demo_hand.csv
demo left demo_left_hand.csv
values() { grep '^[0-9]' "$BUILD_DIR/tests/unit/$1"; }
[ "$(values demo_hand.csv | wc -l)" -eq "$(values demo_left_hand.csv | wc -l)" ] ||
    { echo "the two hands do not perform equally long"; exit 1; }
same=$(paste -d: <(values demo_hand.csv) <(values demo_left_hand.csv) | awk -F: '$1 == $2' | wc -l)
[ "$same" -lt 200 ] || { echo "the left hand does what the right hand does in $same records"; exit 1; }
made() { # file, arguments of demo_face
    local fresh=$BUILD_DIR/tests/unit/$1
    (cd "$SOURCE_DIR/plugins/log" && "$BUILD_DIR/plugins/demo_face" "${@:2}" "$fresh") || exit 1
    cmp "$fresh" "$SOURCE_DIR/plugins/log/$1" || { echo "ninja demo_recordings writes $1 anew"; exit 1; }
}
made demo.csv demo demo_phonemes.csv
made emotions.csv emotions
[ "$(wc -c <"$SOURCE_DIR/plugins/log/demo.ogg")" -le 153600 ] || { echo "demo.ogg is larger than 150 KB"; exit 1; }
