#!/usr/bin/env bash
# A file includes only from its own room or from lower floors; a plugin includes the contract and
# nothing else of marotte. Files of different subjects (a .c and its .h are one), and the folders
# within a room, include each other in no circle.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0
complain() { echo "$1"; failed=1; }

# ---- every include of ours, as "FILE LINE FILE": where the second one lies is looked up ----
edges=$(mktemp)
trap 'rm -f "$edges" "$edges".*' EXIT
find core ui plugins rigs \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' \) | sort >"$edges.files"
grep -nE '^ *# *include +"' -r core ui plugins rigs --include=*.c --include=*.h --include=*.cpp --include=*.hpp >"$edges.lines"
awk -v FILES="$edges.files" '
    function folder(path) { sub("/[^/]*$", "", path); return path }
    function found(path, name) { while (sub("[^/]+/\\.\\./", "", path)); return (path in is_file) ? path : "" }
    BEGIN { while ((getline file <FILES) > 0) is_file[file] = 1 }
    {
        split($0, part, ":")
        file = part[1]; line = part[2]
        match($0, "\"[^\"]*\""); name = substr($0, RSTART + 1, RLENGTH - 2)
        split(file, step, "/")
        at = found(folder(file) "/" name)
        if (at == "") at = found("core/" name)
        if (at == "") at = found("ui/" name)
        if (at == "" && step[1] == "plugins") at = found("plugins/" step[2] "/" name)
        if (at == "") at = found("plugins/hands/" name)
        if (at == "") at = found("plugins/devices/" name)
        if (at == "") at = found("plugins/template/" name)
        print file, line, at == "" ? "?" name : at
    }' "$edges.lines" >"$edges"
checked=$(wc -l <"$edges")

# ---- floors ----
declare -A floor=([base]=0 [csrbf]=1 [hand]=1 [mesh]=1 [face]=2 [io]=2 [show]=3 [check]=3 [stage]=4)
while read -r file line target; do
    case $file in
    core/include/*) complain "$file:$line: the contract includes $target" ;;
    core/*)
        own=$(cut -d/ -f2 <<<"$file")
        room=$(cut -d/ -f2 <<<"$target")
        [ -n "${floor[$own]:-}" ] || { complain "$file: room $own has no floor"; continue; }
        if [[ $target != core/* ]] || [ -z "${floor[$room]:-}" ]; then
            complain "$file:$line: includes $target, which is no room of core"
        elif [ "$room" != "$own" ] && [ "${floor[$room]}" -ge "${floor[$own]}" ]; then
            complain "$file:$line: floor ${floor[$own]} includes $target of floor ${floor[$room]}"
        fi ;;
    plugins/*/*)
        own=$(cut -d/ -f2 <<<"$file")
        # A plugin's own headers lie in its own folder; mappings share hands/, inputs share devices/.
        case $target in
        "plugins/$own/"* | plugins/hands/* | plugins/devices/* | plugins/template/*) ;;
        *) complain "$file:$line: a plugin includes $target" ;;
        esac ;;
    ui/draw/*) [[ $target != ui/window/* ]] || complain "$file:$line: the renderer includes the window, $target" ;;
    esac
done < <(awk '{ split($1, a, "/"); split($3, b, "/") } a[1] != b[1] || a[2] != b[2]' "$edges")

# The rooms of the window, each above those that it may include; what lies in none of them is on top.
declare -A window_floor=([gui]=0 [app]=1 [viewport]=2 [panels]=3 [timeline]=4 [rig]=4 [top]=5)
room_of() { # window/timeline/axis.h -> timeline; window/workspace.c -> top
    local name=${1#window/}
    [[ $name = */* ]] && echo "${name%%/*}" || echo top
}
while IFS=: read -r file line text; do
    checked=$((checked + 1))
    own=$(room_of "${file#ui/}")
    room=$(room_of "$(sed -E 's/.*#include +"([^"]+)".*/\1/' <<<"$text")")
    if [ -z "${window_floor[$own]:-}" ] || [ -z "${window_floor[$room]:-}" ]; then
        complain "$file:$line: room $own or $room has no floor"
    elif [ "$room" != "$own" ] && [ "${window_floor[$room]}" -ge "${window_floor[$own]}" ]; then
        complain "$file:$line: floor ${window_floor[$own]} includes $room of floor ${window_floor[$room]}"
    fi
done < <(grep -rnE '#include +"window/' ui/window --include=*.c --include=*.h --include=*.cpp)

# In angle brackets only <marotte/plugin.h> may be ours.
while IFS=: read -r file line text; do
    complain "$file:$line: $text"
done < <(grep -rnE '#include +<(marotte/[^p]|base/|csrbf/|hand/|mesh/|face/|io/|show/|stage/|check/|draw/|window/)' \
    core plugins ui rigs tests --include=*.c --include=*.h --include=*.cpp)

# ---- circles: of subjects, and of the folders of a room ----
awk '
    function stem(path) { sub("\\.[a-z]+$", "", path); return path }
    # A header that lies apart from its .c belongs to the folder of that.
    function folder(path, s) {
        s = stem(path)
        if (path ~ "\\.h$" && !(s in source)) { sub(".*/", "", s); if (apart[s] != "") return apart[s] }
        sub("/[^/]*$", "", path)
        return path
    }
    function room(path, step) { split(path, step, "/"); return step[1] == "ui" ? "ui" : step[1] "/" step[2] }
    FILENAME == ARGV[1] && /\.c(pp)?$/ {
        s = stem($1); source[s] = 1
        f = $1; sub("/[^/]*$", "", f); sub(".*/", "", s); apart[s] = (s in apart) ? "" : f
        next
    }
    FILENAME == ARGV[1] || $3 ~ "^[?]" { next }
    {
        a = stem($1); b = stem($3)
        if (a != b) print a, b
        a = folder($1); b = folder($3)
        if (a != b && room($1) == room($3)) print a "/", b "/"
    }' "$edges.files" "$edges" | sort -u >"$edges.pairs"
# What is left when all that nobody includes, and all that includes nothing, is taken away again and again.
awk '
    { from[NR] = $1; to[NR] = $2; alive[NR] = 1 }
    END {
        do {
            delete out; delete into
            for (i = 1; i <= NR; ++i) if (alive[i]) { out[from[i]] = 1; into[to[i]] = 1 }
            gone = 0
            for (i = 1; i <= NR; ++i)
                if (alive[i] && (!(from[i] in into) || !(to[i] in out))) { alive[i] = 0; gone = 1 }
        } while (gone)
        for (i = 1; i <= NR; ++i) if (alive[i]) print from[i] " includes " to[i]
    }' "$edges.pairs" >"$edges.circles"
[ ! -s "$edges.circles" ] || { complain "a circle of includes (let one of them not know the other):"; cat "$edges.circles"; }

[ "$checked" -gt 1000 ] || complain "only $checked includes were found: the search is broken"
echo "$checked includes checked"
exit $failed
