#!/usr/bin/env bash
# The guide tells the truth: its code compiles, its commands work in the order in which they stand,
# and its pieces of the template are the template.
source "$(dirname "$0")/lib.sh"
mkdir "$scratch/blocks" "$scratch/work"
awk -v OUT="$scratch/blocks" -f "$SOURCE_DIR/tests/plugin/guide.awk" "$SOURCE_DIR/plugins/README.md"
cd "$scratch/work" || exit 1
export PATH=$BUILD_DIR:$PATH CMAKE_PREFIX_PATH=$BUILD_DIR
c_count=0 sh_count=0

# ---- the template, whole and in order ----
marotte plugin new wave --mapping >/dev/null || fail "plugin new"
squeezed() { grep -v '^$' "$@"; }
cat "$scratch"/blocks/*.template.c | squeezed >"$scratch/told"
squeezed wave/wave.c >"$scratch/written"
diff "$scratch/told" "$scratch/written" || fail "the guide's pieces are not the template (plugins/template/mapping.c)"
rm -r wave

# ---- each block ----
for block in "$scratch"/blocks/*; do
    case $block in
    *.template.c | *.none.text | *.skipped.sh) ;;
    *.none.sh) # in one shell per block; the folder is taken on
        sh_count=$((sh_count + 1))
        if ! command -v gdb >/dev/null && grep -q '^gdb' "$block"; then
            echo "SKIPPED: gdb is not installed"
            sed -i '/^gdb/,/[^\\]$/d' "$block" # with the lines that go on
        fi
        { echo "set -e"; cat "$block"; echo "pwd >'$scratch/folder'"; } >"$scratch/block.sh"
        bash "$scratch/block.sh" >"$scratch/log" 2>&1 || {
            fail "commands of the guide:"
            cat "$block" "$scratch/log"
        }
        cd "$(cat "$scratch/folder")" || exit 1 ;;
    *.file.c | *.process.c | *.read.c)
        c_count=$((c_count + 1))
        kind=${block%.c}
        kind=${kind##*.}
        mkdir -p "$scratch/include" && sed 's/^/    /' "$block" >"$scratch/include/block.h"
        errors=$failures
        compiles "$SOURCE_DIR/tests/plugin/guide/$kind.c" -Wno-unused-function -Wno-unused-variable \
            -Wno-unused-const-variable -D_POSIX_C_SOURCE=200809L -I "$SOURCE_DIR/core/include" -I "$scratch/include"
        [ "$errors" -eq "$failures" ] || cat "$block" ;;
    *) fail "what is to be done with this block is not said: $(basename "$block"): $(head -n 2 "$block")" ;;
    esac
done
[ $c_count -ge 8 ] || fail "only $c_count pieces of code were found"
[ $sh_count -ge 6 ] || fail "only $sh_count lists of commands were found"
echo "$c_count pieces of code, $sh_count lists of commands"

# ---- links lead somewhere ----
while read -r target; do
    case $target in
    http*) ;;
    '#'*) tr '[:upper:]' '[:lower:]' <"$SOURCE_DIR/plugins/README.md" | sed -n 's/^##* //p' | tr -d ',' | tr ' ' '-' |
        grep -qx -- "${target#?}" || fail "no heading $target" ;;
    *) [ -e "$SOURCE_DIR/plugins/${target%%#*}" ] || fail "no file $target" ;;
    esac
done < <(grep -o '](\([^)]*\))' "$SOURCE_DIR/plugins/README.md" | sed 's/](\(.*\))/\1/')
finish
