#!/usr/bin/env bash
# cross.sh arm64|windows: builds the tests of the engine, hand, mesh, face and takes with Debian's cross compiler, and runs them
# by qemu-user or Wine. The last line: tests run and passed, and how many results have the bits that are recorded for x86-64.
# Skips (77) where a tool is missing. ./test --long runs this.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$here/.ci/setup.sh"
cd "$here"
preset=${1:-}
chosen='^(golden/|property/|face/|take/|unit/(base|isa|large|pool|stamps|csrbf|hand_|mesh_(cut|expression|gltf$|obj|off|ply|skin|topology)|weld|surface_meter|shading|bones|fit$|face_|shape_solve|weights|springs|rig_(parse|write|select|check|paint|parts)|mappings|resume|scheduler|sequencer))'

missing() {
    echo "SKIPPED: $1"
    exit 77
}
need() { # PROGRAM PACKAGE
    command -v "$1" >/dev/null || missing "install $2"
}

case $preset in
arm64)
    need aarch64-linux-gnu-g++ g++-aarch64-linux-gnu
    need qemu-aarch64-static qemu-user-static
    # Tests start programs: with binfmt_misc the kernel starts them by qemu. On a usual system the package sets this up.
    [ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || missing "the kernel does not start arm64 programs, mount binfmt_misc and
        write /usr/lib/binfmt.d/qemu-aarch64.conf to its file register"
    sysroot=$here/build/sysroot/arm64
    setup_step "unpacking arm64 libraries" 0 bash .ci/sysroot.sh arm64 "$sysroot"
    export QEMU_LD_PREFIX=$sysroot
    programs=(marotte-program) ;;
windows)
    need x86_64-w64-mingw32-g++ g++-mingw-w64-x86-64-posix
    need wine "wine and wine64"
    export WINEPREFIX=$here/build/wine WINEDEBUG=-all
    # One server for all tests: a program that starts while the last server ends fails.
    mkdir -p "$WINEPREFIX"
    /usr/lib/wine/wineserver -p || true # it runs already
    wine wineboot --init >/dev/null 2>&1
    trap '/usr/lib/wine/wineserver -k' EXIT
    setup_step "building Windows libraries" 0 bash .ci/windows_libraries.sh "$here/build/windows-libraries"
    programs=() ;;
*) echo "usage: tests/cross.sh arm64|windows" >&2; exit 2 ;;
esac

setup_step configuring 0 cmake -S "$here" --preset "$preset" -DMAROTTE_WERROR=ON
mapfile -t names < <(ctest --preset "$preset" -N -R "$chosen" | sed -n 's|^ *Test *#[0-9]*: ||p')
targets=()
for name in "${names[@]}"; do
    [ -f "tests/$name.sh" ] || targets+=("test_${name/\//_}")
done
[ ${#targets[@]} -gt 0 ] || { echo "no test was configured: the log is ${setup_log#"$here"/}"; exit 1; }
targets=("${targets[@]/test_take_hostile_shows/hostile_shows}")
setup_step building 0 cmake --build "build/$preset" --target "${programs[@]}" "${targets[@]}"

report=build/$preset/tests.xml status=0
ctest --preset "$preset" -j "$(nproc)" -R "$chosen" --output-junit "$here/$report" --test-output-size-passed 65536 || status=$?
awk -f tests/summary.awk "$report"
awk -v of="$preset" '
    /<testcase / { run++ }
    /status="notrun"/ { skipped++ }
    /status="fail"/ { failed++ }
    match($0, /[0-9]+ results, [0-9]+ with the recorded bits/) { split(substr($0, RSTART), word, " "); results += word[1]; equal += word[3] }
    END {
        printf "%s: %d tests run, %d passed, %d skipped; %d results, %d with the bits of x86-64\n", of, run - skipped,
            run - skipped - failed, skipped, results, equal
    }' "$report"
exit "$status"
