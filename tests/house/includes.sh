#!/usr/bin/env bash
# A file includes only from its own room or from lower floors; a plugin includes the contract and
# nothing else of marotte.
set -u
cd "$SOURCE_DIR" || exit 1
declare -A floor=([base]=0 [csrbf]=1 [hand]=1 [mesh]=1 [face]=2 [io]=2 [take]=3 [check]=3 [stage]=4)
checked=0
failed=0
complain() { echo "$1"; failed=1; }

while IFS=: read -r file line text; do
    checked=$((checked + 1))
    target=$(sed -E 's/.*#include +["<]([^">]+)[">].*/\1/' <<<"$text")
    room=${target%%/*}
    case $file in
    core/include/*) complain "$file:$line: the contract includes $target" ;;
    core/*)
        own=$(cut -d/ -f2 <<<"$file")
        [ -n "${floor[$own]:-}" ] || { complain "$file: room $own has no floor"; continue; }
        if [ -z "${floor[$room]:-}" ]; then
            complain "$file:$line: includes $target, which is no room of core"
        elif [ "$room" != "$own" ] && [ "${floor[$room]}" -ge "${floor[$own]}" ]; then
            complain "$file:$line: floor ${floor[$own]} includes $target of floor ${floor[$room]}"
        fi ;;
    plugins/*/*)
        own=$(cut -d/ -f2 <<<"$file")
        # A plugin's own headers lie in its own folder; mappings share hands/, inputs share devices/.
        [ -e "plugins/$own/$target" ] || [ -e "plugins/hands/$target" ] || [ -e "plugins/devices/$target" ] || complain "$file:$line: a plugin includes $target" ;;
    esac
done < <(grep -rnE '#include +"' core plugins --include=*.c --include=*.h --include=*.cpp)

# In angle brackets only <marotte/plugin.h> may be ours.
while IFS=: read -r file line text; do
    complain "$file:$line: $text"
done < <(grep -rnE '#include +<(marotte/[^p]|base/|csrbf/|hand/|mesh/|face/|io/|take/|stage/|draw/)' \
    core plugins ui rigs tests --include=*.c --include=*.h --include=*.cpp)

[ "$checked" -gt 30 ] || complain "only $checked includes were found: the search is broken"
echo "$checked includes checked"
exit $failed
