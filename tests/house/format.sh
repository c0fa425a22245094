#!/usr/bin/env bash
# Every source file is as clang-format 14 leaves it.
set -u
cd "$SOURCE_DIR" || exit 1
command -v clang-format >/dev/null || { echo "SKIPPED: clang-format is not installed"; exit 77; }
case $(clang-format --version) in
*"version 14."*) ;;
*) echo "SKIPPED: clang-format is not version 14"; exit 77 ;;
esac
find core plugins ui rigs tests \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) \
    -not -path '*/node_modules/*' -print0 | xargs -0 clang-format --dry-run -Werror
