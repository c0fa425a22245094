#!/usr/bin/env bash
# What ARCHITECTURE.md names is there: each "FILE: NAME, NAME" defines those names (a folder: one of
# its files does), each `FILE` in the text exists, and so does every `name_of_ours`.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0 checked=0
complain() { echo "ARCHITECTURE.md: $1"; failed=1; }

# perform/layer.c, core/hand, window/app/app_open.c ...: the files that are meant; none: no such file.
files_of() {
    local name=${1%/} base
    for base in "" core/ core/include/ core/stage/ core/stage/live/ core/stage/perform/; do
        [ -d "$base$name" ] && find "$base$name" -name '*.[ch]' && return
        [ -f "$base$name" ] && echo "$base$name" && return
    done
}

defines() { # NAME FILES...: a function at the beginning of a line, a type, a constant, a macro
    local name=$1
    shift
    grep -qE "^[A-Za-z_][^;=]*\b$name\(|#define $name\b|^ *$name( =|,|$)|[ *]$name( =|;|\[)|^} $name;" "$@"
}

check() { # FILE NAMES: "a, b → c"
    local found name
    found=$(files_of "$1")
    checked=$((checked + 1))
    [ -n "$found" ] || { complain "$1 is not there"; return; }
    for name in $(tr ',' ' ' <<<"$2"); do
        checked=$((checked + 1))
        # shellcheck disable=SC2086
        defines "$name" $found || complain "$1 has no $name"
    done
}

file='([a-z_]+/)*[a-z_]+(\.[ch]|/[a-z_]+)' names='[A-Za-z_]{2,}(, [A-Za-z_]{2,})*'
# The drawing: names end where two blanks begin the words about them.
while IFS= read -r line; do
    check "${line%%:*}" "${line#*: }"
done < <(awk '/^```/ { inside = !inside; next } inside' ARCHITECTURE.md |
    grep -oE "(^|[ (])$file: $names( {2}|$|[;)])" | sed -E 's/^[ (]+//; s/[ ;)]+$//')
# The text: `FILE: NAMES`, `FILE`, `NAME`.
while IFS= read -r line; do
    check "${line%%:*}" "${line#*: }"
done < <(awk '/^```/ { inside = !inside; next } !inside' ARCHITECTURE.md | grep -oE "\`$file: $names\`" | tr -d '`')
while IFS= read -r name; do
    check "$name" ""
done < <(grep -oE "\`([a-z_]+/)+[a-z_]+\.(c|h|sh)\`" ARCHITECTURE.md | tr -d '`' | sort -u)
while IFS= read -r name; do
    checked=$((checked + 1))
    grep -rqw "$name" core ui --include='*.[ch]' || complain "nothing is called $name"
done < <(grep -oE '`[A-Za-z]+_[A-Za-z_]+`' ARCHITECTURE.md | tr -d '`' | sort -u)

# The picture is drawn from the text.
awk -f tests/house/draw_frame.awk ARCHITECTURE.md | cmp -s - .github/frame.svg ||
    complain ".github/frame.svg is not up to date: awk -f tests/house/draw_frame.awk ARCHITECTURE.md >.github/frame.svg"

# The top of the tree stays these folders; a copy without git has nothing to ask.
for folder in $(git ls-files 2>/dev/null | cut -d/ -f1 -s | sort -u); do
    case $folder in
    core | plugins | rigs | ui | tests | debian | packaging | .ci | .github) ;;
    *) complain "$folder/ is a new folder at the top: it belongs into a room" ;;
    esac
done

[ $checked -ge 100 ] || complain "only $checked names were found: the search is broken"
echo "$checked files and names checked"
exit $failed
