#!/usr/bin/env bash
# The golden takes have the same vertices whoever builds the program: gcc and clang, -O0 and -O3, each
# in a scratch folder. Takes minutes: for ./test --long.
set -u
here=$(cd "$(dirname "$0")" && pwd)
SOURCE_DIR=$(cd "$here/../.." && pwd)
export SOURCE_DIR
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
jobs=${MAROTTE_JOBS:-2}
failures=0

replay() { # compiler of C, of C++, optimisation
    local build=$scratch/$1$3
    command -v "$1" >/dev/null || { echo "SKIPPED: there is no $1"; return; }
    { cmake -G Ninja -S "$SOURCE_DIR" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$1" \
        -DCMAKE_CXX_COMPILER="$2" -DCMAKE_C_FLAGS_RELEASE="$3" -DCMAKE_CXX_FLAGS_RELEASE="$3" &&
        ninja -C "$build" -j "$jobs" marotte-program; } >"$scratch/log" 2>&1 ||
        { echo "FAILED: $1 $3 does not build: $(grep -E 'error|FAILED' "$scratch/log" | head -n 3)"
          failures=$((failures + 1)); return; }
    if MAROTTE=$build/marotte BUILD_DIR=$build bash "$here/golden.sh"; then
        echo "$1 $3: the same vertices"
    else
        failures=$((failures + 1))
    fi
    rm -rf "$build"
}
replay gcc g++ -O0
replay gcc g++ -O3
replay clang clang++ -O0
replay clang clang++ -O3
[ "$failures" -eq 0 ]
