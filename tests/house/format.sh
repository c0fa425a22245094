#!/usr/bin/env bash
# Every source file is as clang-format 14 leaves it.
set -u
cd "$SOURCE_DIR" || exit 1
formatter=
for name in clang-format-14 clang-format; do
    case $($name --version 2>/dev/null) in
    *"version 14."*) formatter=$name && break ;;
    esac
done
[ -n "$formatter" ] || { echo "SKIPPED: clang-format 14 is not installed"; exit 77; }
find core plugins ui rigs tests \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) \
    -not -path '*/node_modules/*' -print0 | xargs -0 $formatter --dry-run -Werror
