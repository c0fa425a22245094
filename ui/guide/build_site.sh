#!/usr/bin/env bash
# build_site.sh MAROTTE FOLDER: pandoc makes the site of the guides that contents.txt lists, and a page of what `marotte help` prints.
# The site needs no network: its search reads an index that this writes. Without pandoc: exit code 77.
set -euo pipefail
command -v pandoc >/dev/null || { echo "SKIPPED: pandoc is not installed"; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
marotte=$1
folder=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/site/pictures"
cp "$here"/site/{site.css,search.js} "$work/site/"
cd "$top"

page_of() { # GUIDE.md: the name of its page
    local name=${1%.md}
    case $name in
    README) echo index.html ;;
    *) name=${name%/README}; name=${name##*/}; echo "${name,,}.html" ;;
    esac
}
export PAGES=$work/pages INDEX=$work/index
grep -v '^#' "$here/contents.txt" | while read -r guide _; do printf '%s\t%s\n' "$(page_of "$guide")" "$guide"; done >"$PAGES"
[ -z "$(cut -f1 "$PAGES" | sort | uniq -d)" ] || { echo "two guides have one page: $(cut -f1 "$PAGES" | sort | uniq -d)"; exit 1; }

# The commands, as the program explains them.
explain() { # COMMAND WORDS
    printf '\n## marotte %s\n\n```text\n' "$*"
    "$marotte" help "$@"
    printf '```\n'
}
commands=commands.md
{
    printf '# Commands\n\nWhat `marotte help` and `marotte help COMMAND` print.\n\n```text\n'
    "$marotte" help
    printf '```\n'
    for command in $("$marotte" help | awk '/^Commands:/ { on = 1; next } /^$/ { on = 0 } on { print $1 }'); do
        explain "$command"
        [ "$command" != take ] || "$marotte" help take | sed -nE 's/^  (([a-z]+ ){1,2})SHOW.*/\1/p' | while read -r verb; do
            # shellcheck disable=SC2086 # one or two words
            explain take $verb
        done
    done
} >"$work/$commands"
printf 'commands.html\t%s\n' "$commands" >>"$PAGES"

row() { echo "<li><a href=\"$1\">$2</a></li>"; }
{
    echo "<ul>"
    sed 1d "$here/contents.txt" | while read -r guide name; do
        case $guide in
        "#") echo "</ul><h2>$name</h2><ul>"; [ "$name" != Reference ] || row commands.html Commands ;;
        *) row "$(page_of "$guide")" "$name" ;;
        esac
    done
    echo "</ul>"
} >"$work/contents"

: >"$INDEX"
write_page() { # PAGE GUIDE FILE
    PAGE=$1 GUIDE=$2 pandoc --from gfm --to html5 --template "$here/site/page.html" --lua-filter "$here/site/links.lua" \
        --toc --toc-depth 2 --variable "contents=$(cat "$work/contents")" --metadata title=marotte --no-highlight \
        "$3" -o "$work/site/$1"
}
while IFS=$'\t' read -r page guide; do
    file=$guide
    [ "$guide" != "$commands" ] || file=$work/$commands
    write_page "$page" "$guide" "$file"
done <"$PAGES"
{ echo "'use strict';"; echo "const sections = ["; cat "$INDEX"; echo "];"; } >"$work/site/sections.js"
grep -ohE 'src="pictures/[^"]+"' "$work"/site/*.html | cut -d/ -f2 | tr -d '"' | sort -u | while read -r picture; do
    cp ".github/$picture" "$work/site/pictures/"
done
rm -rf "$folder"
mkdir -p "$(dirname "$folder")"
mv "$work/site" "$folder"
