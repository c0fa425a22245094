#!/usr/bin/env bash
# Two builds in folders of other names and lengths, at other times, give the same bytes of everything that is installed.
# twice.sh portable: of the portable archive. Half an hour: ./test --long runs it.
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export CCACHE_DISABLE=1 # it would hand out the first build's files
cd "$here"
for folder in one other/folder/of/marotte; do
    mkdir -p "$scratch/$folder"
    git ls-files -z --cached | tar --null --files-from=- --create | tar --extract --touch --directory "$scratch/$folder"
    if [ "${1:-}" = portable ]; then
        export SOURCE_DATE_EPOCH=1
        bash "$scratch/$folder/packaging/portable/build.sh"
        mkdir -p "$scratch/made/$folder"
        cp "$scratch/$folder"/build/portable/*.tar.zst "$scratch/made/$folder/"
        continue
    fi
    cmake -S "$scratch/$folder" --preset release >/dev/null
    cmake --build "$scratch/$folder/build/release" --target marotte-program
    cmake --install "$scratch/$folder/build/release" --prefix "$scratch/made/$folder" --strip >/dev/null
done
if ! diff -r "$scratch/made/one" "$scratch/made/other/folder/of/marotte"; then
    ! command -v diffoscope >/dev/null || diffoscope "$scratch/made/one" "$scratch/made/other/folder/of/marotte" | head -n 60
    echo "two builds differ"
    exit 1
fi
echo "$(find "$scratch/made/one" -type f | wc -l) files, the same bytes"
