#!/usr/bin/env bash
# Every word of a comment, a string or a guide that looks like one of our source files names a file
# of the tree, with the folders that it gives; the first line of a header of the program names its
# own path.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0
complain() { echo "$1"; failed=1; }

files=$(find core ui plugins rigs tests run README.md ARCHITECTURE.md CONTRIBUTING.md -type f \
    -not -path '*/build/*' -not -path '*/node_modules/*' -not -path '*/golden/*' -not -path '*/seeds/*')
# Of the C library, of libraries, made by the build, or in the examples of a guide.
others='cmocka.h math.h linux/input.h wave.c s.c a.c a.b.c shaders.c template_name.c FOLDER_OF_marotte/plugin.h NAME.c
ui/cli/NAME.c tests/FOLDER/NAME.c tests/fuzz/fuzz_NAME.c FILE.c fuzz_NAME.c'

# FILE:LINE WORD, but for what is included.
said=$(grep -E '^(core|ui|plugins|rigs)/.*\.(c|h|cpp|hpp|md)$|^tests/.*\.(c|h|cpp)$|^[A-Z]+\.md$' <<<"$files" |
    xargs awk '
    /^[ \t]*#[ \t]*include/ { next }
    {
        rest = " " $0
        while (match(rest, /[^A-Za-z0-9_.\/%-][A-Za-z0-9_][A-Za-z0-9_.\/-]*\.(c|h|cpp|hpp)([^A-Za-z0-9_(]|$)/)) {
            word = substr(rest, RSTART + 1, RLENGTH - 1)
            sub(/[^A-Za-z0-9_]$/, "", word)
            print FILENAME ":" FNR, word
            rest = substr(rest, RSTART + RLENGTH - 1)
        }
    }')
count=$(wc -l <<<"$said")
[ "$count" -gt 1000 ] || { echo "only $count names were found: the search is broken"; exit 1; }
wrong=$(awk -v others="$others" '
    BEGIN { split(others, list, /[ \n]+/); for (i in list) is_there[list[i]] = 1 }
    NR == FNR { # every end of a path: b/c.h and c.h of a/b/c.h
        name = $0
        is_there[name] = 1
        while (sub(/^[^\/]*\//, "", name)) is_there[name] = 1
        next
    }
    !($2 in is_there) { print $1 ": there is no " $2 }' <(echo "$files") <(echo "$said"))
[ -z "$wrong" ] || complain "$wrong"

# A formatter of C once took a guide for code.
while read -r guide; do
    head -n 1 "$guide" | grep -q '^# [A-Za-z]' || complain "$guide: the first line is not a title, \"# ...\""
done < <(grep -E '\.md$' <<<"$files")

while IFS= read -r header; do
    read -r open name rest <"$header"
    [ "${name%/*}" != "$name" ] && [[ $open = '/*' && /$header = */$name ]] && continue
    complain "$header: its first line is '$open $name $rest'"
done < <(grep -E '^(core|ui|plugins)/.*\.(h|hpp)$' <<<"$files")
exit $failed
