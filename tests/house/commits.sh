#!/usr/bin/env bash
# The first line of each of the last 50 commits is "room: what changed", at most 100 characters, without a full stop at its end.
# A merge, a revert and a fixup keep the line that git writes.
set -u
cd "$SOURCE_DIR" || exit 1
if ! git rev-parse --verify -q HEAD >/dev/null 2>&1; then
    echo "SKIPPED: no git checkout"
    exit 77
fi
failed=0
while read -r hash subject; do
    case $subject in
    "Merge "* | "Revert "* | "fixup! "* | "squash! "*) continue ;;
    esac
    grep -qE '^[A-Za-z0-9_ ,./-]+: [^ ].*[^.]$' <<<"$subject" && [ ${#subject} -le 100 ] && continue
    echo "$hash: \"$subject\" is not \"room: what changed\" in at most 100 characters"
    failed=1
done < <(git log -50 --format='%h %s')
exit $failed
