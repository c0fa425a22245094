#!/usr/bin/env bash
# Every command of CONTRIBUTING.md works: what takes seconds is run; of builds and tests is seen that
# there are such presets, targets and tests; of scripts that take longer, that they are there. Every
# file that it names is there too.
source "$(dirname "$0")/../e2e/lib.sh"
cd "$SOURCE_DIR" || exit 1
mkdir "$scratch/blocks"
awk -v OUT="$scratch/blocks" -f tests/plugin/guide.awk CONTRIBUTING.md
cmake --list-presets >"$scratch/presets" || fail "cmake --list-presets"
count=0

works() { # COMMAND SKIPPED: whether it is only looked at
    local preset=${1#*--preset }
    preset=${preset%% *}
    case $1 in
    ctest*) [ ! -e "build/$preset/build.ninja" ] || bash -c "$1 -N" | grep -q 'Total Tests: [1-9]' ;;
    "cmake --preset"*) grep -q "\"$preset\"" "$scratch/presets" ;;
    "cmake --build"*) [ ! -e "build/$preset/build.ninja" ] || bash -c "$1 -- -n" ;;
    ./build/release/marotte*) bash -c "$MAROTTE${1#./build/release/marotte}" ;;
    bash*) set -- $1 "$2" && [ -e "$2" ] && bash -n "$2" ;;
    *) [ "$2" = sh ] && bash -c "$1" ;;
    esac
}

for block in "$scratch"/blocks/*.sh; do
    kind="sh"
    [[ $block != *.skipped.sh ]] || kind=skipped
    while read -r line; do
        count=$((count + 1))
        echo "\$ $line"
        works "$line" $kind >"$scratch/log" 2>&1 || { fail "$line"; tail -n 5 "$scratch/log"; }
    done <"$block"
done
[ $count -ge 10 ] || fail "only $count commands were found"

# `core/base/file.h`, `tests/house/format.sh` ...: what has no capital placeholder and no star in it.
names=0
while read -r name; do
    names=$((names + 1))
    [ -e "$name" ] || [ -e "core/$name" ] || fail "CONTRIBUTING.md names $name, which is not there"
done < <(grep -oE '`(core|ui|tests|plugins|rigs|stage|base|take|io|face|window)/[a-z_/0-9.]+`' CONTRIBUTING.md | tr -d '`' | sort -u)
[ $names -ge 10 ] || fail "only $names names of files were found"
while read -r target; do
    [ -e "${target%%#*}" ] || fail "CONTRIBUTING.md links to $target"
done < <(grep -oE '\]\([^)h#][^)]*\)' CONTRIBUTING.md | sed 's/](\(.*\))/\1/')
echo "$count commands, $names names"
finish
