#!/usr/bin/env bash
# The engine beside VTK, scipy, numpy, Eigen and Blender, as far as they are installed (Debian:
# python3-vtk9 python3-scipy python3-numpy libeigen3-dev blender): how many times faster it is, each
# pair measured in one process. Not a test: a clock decides nothing here.
#   tests/bench/peers.sh [BUILD_FOLDER]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=${1:-$here/../../build/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python=python3
[ -x /usr/bin/python3 ] && python=/usr/bin/python3 # Debian's has Debian's modules

cmake --build "$build" --target bench_peers_ours >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
ours=$build/tests/bench/libbench_peers_ours.so
eigen=
for folder in /usr/include/eigen3 /usr/local/include/eigen3; do
    [ -d "$folder" ] || continue
    g++ -std=c++17 -O3 -march=native -DNDEBUG -shared -fPIC -isystem "$folder" \
        -o "$work/libeigen.so" "$here/peers_eigen.cpp" && eigen=$work/libeigen.so
    break
done
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MAROTTE_THREADS=1
"$python" "$here/peers.py" "$ours" $eigen
if command -v blender >/dev/null; then
    blender -b -t 1 --factory-startup -noaudio --python-exit-code 1 -P "$here/peers_blender.py" -- \
        "$ours" "$here" | grep -E '^(Blender [0-9].*(first|$)|Blender,)'
else
    echo "Blender: not installed, skipped"
fi
