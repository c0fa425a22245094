#!/bin/sh
# manual.sh SOURCES OUT VERSION PROGRAM...: writes the manual pages and the completions of shells to OUT/man and OUT/completions,
# from the help and the options that the program prints, and from the guides in SOURCES. Needs awk.
set -eu
sources=$1 out=$2 version=$3
shift 3
pages=$sources/ui/manual/pages.awk
date=$(sed -n 's/.*<release version="[^"]*" date="\([^"]*\)".*/\1/p' "$sources/ui/desktop/org.marotte.Marotte.metainfo.xml" | head -n 1)
rm -rf "$out/man" "$out/completions"
mkdir -p "$out/man/man1" "$out/man/man5" "$out/completions"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$@" help --options >"$scratch/options"
cut -f 1,2 "$scratch/options" | grep '^[a-z]' >"$scratch/names"
tab=$(printf '\t')
# The help of each command; after that of a command, those of its subcommands that have a help of their own.
while IFS=$tab read -r name about; do
    # shellcheck disable=SC2086
    "$@" help $name >"$scratch/text"
    first=${name%% *}
    if [ "$name" = "$first" ]; then
        cp "$scratch/text" "$scratch/$first.help"
        printf '%s\n' "$about" >"$scratch/$first.about"
    elif ! cmp -s "$scratch/text" "$scratch/$first.whole"; then
        { printf '=== %s\n' "$name"; cat "$scratch/text"; } >>"$scratch/$first.help"
    fi
    [ "$name" != "$first" ] || cp "$scratch/text" "$scratch/$first.whole"
    { printf '=== %s\n' "$name"; cat "$scratch/text"; } >>"$scratch/help"
done <"$scratch/names"

page() { # PAGE SECTION ABOUT ALSO ARGUMENTS OF AWK...
    name=$1 section=$2 summary=$3 others=$4
    shift 4
    LC_ALL=C.UTF-8 awk -v page="$name" -v section="$section" -v about="$summary" -v date="$date" -v version="$version" \
        -v also="$others" -f "$pages" "$@" >"$out/man/man$section/$name.$section"
}
commands="" formats="marotte-show(5) marotte-rig(5) marotte-log(5) marotte-patch(5)"
for help in "$scratch"/*.help; do
    name=$(basename "$help" .help)
    commands="$commands marotte-$name(1)"
    page "marotte-$name" 1 "$(cat "$scratch/$name.about")" "marotte(1) $formats" "$help"
done
"$@" help | sed -n '3,$p' >"$scratch/all"
page marotte 1 "perform a face with your hands" "${commands# } $formats" "$scratch/all"
page marotte-show 5 "the file of takes and their edits" "marotte(1) marotte-take(1)" -v markdown=1 -v from="# " "$sources/core/show/show_format.md"
rig=$(grep -lE '^##? The rig file$' "$sources"/rigs/*.md | head -n 1)
page marotte-rig 5 "the description of a face that can be performed" "marotte(1) marotte-rig(1)" -v markdown=1 \
    -v from="$(grep -m 1 -E '^##? The rig file$' "$rig")" -v to="## The Moai" "$rig"
page marotte-log 5 "a recorded hand" "marotte(1) marotte-perform(1)" -v markdown=1 -v from="## The log table" -v to="## The recordings" "$sources/plugins/log/README.md"
page marotte-patch 5 "what faders, sticks and tracked shapes move" "marotte(1) marotte-perform(1)" -v markdown=1 -v from="# " "$sources/ui/patches/README.md"

for shell in bash zsh fish; do
    LC_ALL=C.UTF-8 awk -v shell=$shell -f "$sources/ui/manual/completions.awk" "$scratch/options" "$scratch/help" >"$out/completions/marotte.$shell"
done
