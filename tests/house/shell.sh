#!/usr/bin/env bash
# Every script passes shellcheck at the level of warnings. Left out: files that are sourced from a computed path, and the
# variables that these share (SC1091, SC2034, SC2154).
set -u
cd "$SOURCE_DIR" || exit 1
command -v shellcheck >/dev/null || { echo "SKIPPED: shellcheck is not installed (package shellcheck)"; exit 77; }
mapfile -t scripts < <(find .ci core debian plugins rigs tests ui run test -type f -not -path '*/node_modules/*' -not -path '*/seeds/*' \
    -exec awk 'FNR <= 6 && /^#!.*sh$|^# shellcheck shell/ { print FILENAME; nextfile }' {} +)
[ ${#scripts[@]} -gt 80 ] || { echo "only ${#scripts[@]} scripts were found: the search is broken"; exit 1; }
shellcheck --severity=warning --exclude=SC1091,SC2034,SC2154 --format=gcc "${scripts[@]}" || exit 1
echo "${#scripts[@]} scripts"
