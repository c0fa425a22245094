#!/usr/bin/env bash
# The guides are sound Markdown (tests/house/markdown.rb), all are on the site, and the site has no dead link: neither to a page, nor to
# a section, nor to a picture. Every section can be searched.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0
complain() { echo "$1"; failed=1; }

mapfile -t guides < <(git ls-files '*.md' 2>/dev/null)
[ ${#guides[@]} -gt 0 ] || { echo "SKIPPED: no git checkout"; exit 77; }
if command -v mdl >/dev/null; then
    mdl --style tests/house/markdown.rb "${guides[@]}" >/dev/null || complain "$(mdl --style tests/house/markdown.rb "${guides[@]}" | grep ': MD')"
else
    echo "SKIPPED in part: mdl is not installed (ruby-mdl)"
fi

# Guides of users: on the site. The others belong to rooms, templates and the forge.
for guide in "${guides[@]}"; do
    case $guide in
    core/*/README.md | ui/README.md | ui/*/README.md | plugins/template/* | .github/* | tests/*) continue ;;
    esac
    grep -q "^$guide " ui/guide/contents.txt || complain "ui/guide/contents.txt lacks $guide"
done

# What they link to is there.
while IFS=: read -r guide target; do
    case $target in http* | mailto* | "#"*) continue ;; esac
    file=$(dirname "$guide")/${target%%#*}
    [ -e "$file" ] || complain "$guide links to $target, which is not there"
done < <(grep -oHE '\]\([^) ]+\)' "${guides[@]}" | sed -E 's/\]\(([^)]+)\)/\1/')

site=$(mktemp -d)
trap 'rm -rf "$site"' EXIT
bash ui/guide/build_site.sh "$MAROTTE" "$site/site" >"$site/said" 2>&1
case $? in
0) ;;
77) echo "SKIPPED in part: $(cat "$site/said")"; exit $failed ;;
*) complain "the site is not built: $(tail -n 3 "$site/said")"; exit $failed ;;
esac
cd "$site/site" || exit 1
grep -oHE '(href|src)="[^"]*"' ./*.html | sed -E 's/^\.\/([^:]*):(href|src)="/\1 /; s/"$//' | sort -u >../links
while read -r page target; do
    case $target in [a-z]*:*) continue ;; esac
    file=${target%%#*}
    [ -e "${file:-$page}" ] || { complain "$page links to $target, which is not there"; continue; }
    [[ $target != *"#"* ]] || grep -qF "id=\"${target#*#}\"" "${file:-$page}" || complain "$page links to $target, a section that is not there"
done <../links
sections=$(grep -c '^\["' sections.js)
headings=$(cat ./*.html | grep -cE '<h[1-6] id=')
[ "$sections" -ge $((headings * 9 / 10)) ] || complain "only $sections of $headings sections can be searched"
! command -v node >/dev/null || node --check sections.js || complain "the index of the search is no JavaScript"
exit $failed
