#!/usr/bin/env bash
# run.sh [SECONDS] [TARGET...] - runs every fuzz target (or those named) for SECONDS (60) each, from
# the seeds in the repository and the corpus of earlier runs. Fails on a finding, which it leaves in
# build/fuzz/fuzz/findings: put it into seeds/ and mend the cause.
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
failed=0
mkdir -p "$build/findings"
for target in "${targets[@]}"; do
    corpus=$build/corpus/$target
    log=$build/$target.log
    mkdir -p "$corpus"
    if "$build/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=3000 \
        -max_len=65536 -print_final_stats=1 -artifact_prefix="$build/findings/$target-" \
        "$corpus" "$here/seeds/$target" >"$log" 2>&1; then
        echo "$target: $(grep -a number_of_executed_units "$log" | grep -o '[0-9]*$') runs, no finding"
    else
        echo "$target: FINDING, see $log"
        tail -n 40 "$log"
        failed=1
    fi
done
exit $failed
