#!/usr/bin/env bash
# long.sh [STEP...]: what takes hours: sanitizers, fuzz targets, repetition on a busy machine, soaks. Without an argument every
# step, in order. Each step writes its row of tests/LONG.md, so that the table shows when and on which commit it last ran; its
# output is in build/long/STEP.log. ./test --long runs this.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$here/.ci/setup.sh"
cd "$here" || exit 1
export MAROTTE_TEST_LONG=yes # repeats whatever only more of the same makes surer
SOURCE_DIR=$here
export SOURCE_DIR
cores=$(nproc)
jobs=$((cores + 2))
table=tests/LONG.md logs=build/long
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# NAME:WHAT. The function step_NAME does it, and the last line that it prints is the figure of the table.
steps=(
    "asan:all of ctest under the address and undefined-behaviour sanitizers, in one piece"
    "tsan:all of ctest under the thread sanitizer, in one piece"
    "clang:all of ctest, built with clang"
    "fuzz:each fuzz target for ten minutes under the address and undefined-behaviour sanitizers"
    "heads:mutated heads through \`rig new\`, every mapping and every export for an hour, under the address sanitizer"
    "timed:every test that has a thread, a process or a clock, 50 times beside two busy loops"
    "busy:\`./test\`, ten times beside two busy loops"
    "whole:all of ctest with every repetition in full"
    "tidy:clang-tidy"
    "replays:golden takes on gcc and clang, -O0 and -O3"
    "twice:two builds in folders of other names, at other times: the same bytes"
    "portable:the portable archive: golden takes, and two builds of it: the same bytes"
    "arm64:engine, hand, mesh, face and takes for arm64, in qemu-user"
    "windows:engine, hand, mesh, face and shows for Windows, in Wine"
    "window:the window, clicked at random: an hour, and ten minutes under the address sanitizer"
    "shows:hostile shows through every command for an hour"
    "outputs:a face sent to all outputs, an hour of \`perform\` and ten minutes of the stage"
    "package:the Debian packages on a bare Debian 12: lintian, blhc, the demo, the window, purged without a trace"
    "repeats:600 random edits undone, 100 replugs of a glove, 100 checks of each plugin, pictures of the rig and the viewport"
)

built() { # PRESET [TARGET]: builds it, and sets the variables that test scripts read
    setup_build "$1" "${2:-all}" -DMAROTTE_WERROR=ON
    export BUILD_DIR=$here/build/$1 MAROTTE=$here/build/$1/marotte
}
busy_loops() { # until the step ends
    local loops=() i
    for i in 1 2; do
        (while :; do :; done) &
        loops+=($!)
    done
    # shellcheck disable=SC2064
    trap "kill ${loops[*]}" EXIT
}
counted() { # LOG: the closing line of ctest
    sed -n 's/.*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\).*/\2 tests, \1 failed/p' "$1" | tail -n 1
}
ctest_of() { # PRESET ARGS...
    local status
    ctest --preset "$@" | tee "$scratch/ctest"
    status=$?
    counted "$scratch/ctest"
    return $status
}

# What a sanitizer finds, it finds in the quick run of a test.
step_asan() { unset MAROTTE_TEST_LONG && built asan && ctest_of asan -j "$jobs"; }
step_tsan() { unset MAROTTE_TEST_LONG && built tsan && ctest_of tsan -j "$jobs"; }
# Warnings are errors with gcc only; clang has more of them.
step_clang() { setup_build clang all -DMAROTTE_WERROR=OFF && ctest_of clang -j "$jobs"; }
step_fuzz() { setup_build fuzz all -DMAROTTE_WERROR=OFF && bash tests/fuzz/run.sh "${MAROTTE_FUZZ_S:-600}"; }
step_heads() { built asan hostile_heads && build/asan/tests/e2e/hostile_heads 3600; }
step_timed() { built release && busy_loops && ctest_of release -L timed --repeat until-fail:50 -j "$cores"; }
step_busy() {
    local run failed=0
    busy_loops
    for run in {1..10}; do
        env -u MAROTTE_TEST_LONG ./test >"$scratch/run" || failed=$((failed + 1))
        echo "run $run: $(counted "$scratch/run"), $(sed -n 's/^Total Test time.*= *//p' "$scratch/run")"
    done
    echo "10 runs, $failed failed"
    [ $failed -eq 0 ]
}
step_whole() { built release && ctest_of release -j "$jobs"; }
step_tidy() { built release && bash tests/house/tidy.sh && echo "no finding"; }
step_replays() { bash tests/take/replay_builds.sh; }
step_twice() { bash tests/e2e/twice.sh; }
step_portable() {
    bash packaging/portable/build.sh &&
        MAROTTE=$here/build/portable/marotte/bin/marotte bash tests/take/golden.sh && bash tests/e2e/twice.sh portable
}
step_arm64() { setup_install "${setup_arm64_packages[@]}" && bash tests/cross.sh arm64; }
step_windows() { setup_install "${setup_windows_packages[@]}" && bash tests/cross.sh windows; }
step_window() {
    built asan && bash tests/window/soak.sh 600 && built release && bash tests/window/soak.sh 3600
}
step_shows() { built release && build/release/tests/take/hostile_shows 3600; }
step_outputs() {
    built release && bash tests/e2e/outputs_soak.sh 3600 perform && bash tests/e2e/outputs_soak.sh 600 stage
}
step_package() { bash tests/package/debian.sh; }
step_repeats() {
    built release && MAROTTE_ACTIONS=600 build/release/tests/window/test_window_undo &&
        MAROTTE_REPLUGS=100 build/release/tests/device/test_device_glove_replug &&
        MAROTTE_CHECK_REPEAT=100 bash tests/plugin/check_shipped.sh &&
        MAROTTE_RECORDINGS_FPS=60 bash tests/e2e/recordings.sh && # skips itself without ../shared
        MAROTTE_PICTURES=yes ctest_of release -j "$jobs" -R '^window/(rig|viewport)_'
}

# write_row STEP RESULT FIGURE TOOK_S: replaces the step's row, keeps the others, in the order of $steps.
write_row() {
    local entry name row
    {
        echo "# What takes hours"
        echo
        echo "\`./test --long [STEP...]\` ran these last, and wrote this table. A step that failed is a fault to find."
        echo
        echo "| step | what | result | figures | took | date | commit |"
        echo "|---|---|---|---|---|---|---|"
        for entry in "${steps[@]}"; do
            name=${entry%%:*}
            row="| $name | ${entry#*:} | not run | | | | |"
            if [ "$name" = "$1" ]; then
                row="| $name | ${entry#*:} | $2 | $3 | $(setup_time "$4") | $(date -u +%F) | $(git describe --always --dirty --exclude '*') |"
            elif grep -q "^| $name |" "$table" 2>/dev/null; then
                row=$(grep -m 1 "^| $name |" "$table")
            fi
            echo "$row"
        done
    } >"$scratch/table"
    cp "$scratch/table" "$table"
}

chosen=("$@")
[ $# -gt 0 ] || for entry in "${steps[@]}"; do chosen+=("${entry%%:*}"); done
for name in "${chosen[@]}"; do
    declare -F "step_$name" >/dev/null || { echo "there is no step \"$name\": ${steps[*]%%:*}" >&2; exit 2; }
done
setup_install_tests "${setup_long_packages[@]}"
mkdir -p "$logs"
failed=0
for name in "${chosen[@]}"; do
    echo "== $name"
    began=$SECONDS status=0
    ("step_$name") 2>&1 | tee "$logs/$name.log" || status=${PIPESTATUS[0]}
    result=passed
    [ $status -eq 0 ] || result="failed ($status)" failed=$((failed + 1))
    [ $status -ne 77 ] || result=skipped failed=$((failed - 1))
    write_row "$name" "$result" "$(tail -n 1 "$logs/$name.log" | tr '|' ' ')" $((SECONDS - began))
done
echo "$((${#chosen[@]} - failed)) passed, $failed failed"
[ $failed -eq 0 ]
