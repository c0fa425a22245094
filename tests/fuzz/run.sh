#!/usr/bin/env bash
# run.sh [SECONDS] [TARGET...]: runs every fuzz target, or those named, for SECONDS (60) each, as many at once as $MAROTTE_JOBS or
# the number of processors says, from the seeds in the repository and the corpus of earlier runs. A finding is left in
# build/fuzz/fuzz/findings: put it into seeds/ and mend the cause. Prints a line a target, and the sum last.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=${BUILD_DIR:-$here/../../build/fuzz}/fuzz
seconds=${1:-60}
[ $# -gt 0 ] && shift
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
    for program in "$build"/fuzz_*; do
        [ -x "$program" ] && [ -f "$program" ] && targets+=("${program##*/fuzz_}")
    done
fi
if [ ${#targets[@]} -eq 0 ]; then
    echo "no fuzz targets in $build: cmake --preset fuzz && cmake --build --preset fuzz"
    exit 1
fi
mkdir -p "$build/findings"
export here build seconds
run_one() {
    local target=$1 corpus=$build/corpus/$1 log=$build/$1.log
    mkdir -p "$corpus"
    if "$build/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=3000 \
        -max_len=65536 -print_final_stats=1 -artifact_prefix="$build/findings/$target-" \
        "$corpus" "$here/seeds/$target" >"$log" 2>&1; then
        echo "$target: $(grep -a number_of_executed_units "$log" | grep -o '[0-9]*$') runs, no finding"
    else
        echo "$target: FINDING, see $log"
        tail -n 40 "$log"
    fi
}
export -f run_one
lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
printf '%s\n' "${targets[@]}" | xargs -P "${MAROTTE_JOBS:-$(nproc)}" -I '{}' bash -c 'run_one {}' | tee "$lines"
awk -v seconds="$seconds" '/ runs, no finding$/ { runs += $2; ++fine } / FINDING, / { ++found }
    END { printf "%d targets, %d s each, %d runs, %d findings\n", fine + found, seconds, runs, found; exit found > 0 }' "$lines"
