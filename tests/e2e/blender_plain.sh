#!/usr/bin/env bash
# The Blender add-on without Blender: hostile files, floods of packets, paths that a .blend names.
source "$(dirname "$0")/lib.sh"
command -v python3 >/dev/null || { echo "SKIPPED: python3 is not installed"; exit 77; }
timeout 300 python3 "$SOURCE_DIR/tests/e2e/blender_plain.py" || fail "the add-on"
finish
