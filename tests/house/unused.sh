#!/usr/bin/env bash
# What a file of core/ or ui/ gives to others is asked for by another file, of the program or of the
# tests: else it is static, or it goes. Looks into the objects of the build; a folder that was built
# before may hold some whose source has gone, which do not count.
set -u
on_the_way='' # whose users come next
cd "$BUILD_DIR" || exit 1
symbols=$(mktemp)
trap 'rm -f "$symbols"' EXIT
find . -name '*.o' -path '*/CMakeFiles/*.dir/*' -print0 | xargs -0 nm -A -g 2>/dev/null | awk -v sources="$SOURCE_DIR" '
    {
        # ./core/mesh/CMakeFiles/marotte_mesh.dir/weld.c.o -> core/mesh/weld.c
        source = substr($1, 3, index($1, ".o:") - 3)
        sub("CMakeFiles/[^/]*\\.dir/", "", source)
        if (!(source in is_there)) is_there[source] = source ~ /Unity\/unity_/ || system("test -f \"" sources "/" source "\"") == 0
        if (is_there[source]) print source, $(NF - 1), $NF
    }' >"$symbols"
count=$(wc -l <"$symbols")
[ "$count" -gt 10000 ] || { echo "only $count symbols were found: the search is broken"; exit 1; }
awk -v on_the_way="$on_the_way" '
    $2 == "U" { asked[$3] = asked[$3] "\n" $1; next }
    # Not C++ names, the trap of libc (sanitizer builds leave its other half out), and what plugins and sanitizers are asked for.
    $2 ~ /^[TDRB]$/ && $1 ~ /^(core|ui)\// && $1 !~ /check\/child\/trap/ && $3 !~ /^(_|main$|marotte_plugins$)/ { of[$3] = $1 }
    END {
        for (name in of) {
            count = split(asked[name], who, "\n")
            others = 0
            for (i = 1; i <= count; ++i) others += who[i] != "" && who[i] != of[name]
            if (!others && !index(on_the_way, " " name " ")) print of[name] ": " name " is asked for nowhere else: static, or not needed"
        }
    }' "$symbols" | sort >"$symbols.found"
cat "$symbols.found"
[ ! -s "$symbols.found" ]
failed=$?
rm -f "$symbols.found"
exit $failed
