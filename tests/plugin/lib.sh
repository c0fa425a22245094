# What the scripts about plugins share, beside tests/e2e/lib.sh. Sourced.
# shellcheck shell=bash
source "$SOURCE_DIR/tests/e2e/lib.sh"
export XDG_DATA_HOME=$scratch/data # no plugins of whoever runs the tests
unset MAROTTE_PLUGIN_PATH
[ -n "${MAROTTE_TEST_LONG:-}" ] || export MAROTTE_CHECK_DIVISOR=10 # of the frames of a check; what ships has all of them
strict=(-Wall -Wextra -Wpedantic -Werror -fsyntax-only)

# compiles FILE FLAGS...: without a warning, as C11, C17 and C++17, with each compiler that is here.
compiles() {
    local file=$1 standard compiler
    shift
    for compiler in cc clang; do
        command -v $compiler >/dev/null || continue
        for standard in c11 c17; do
            $compiler -std=$standard "${strict[@]}" -Wstrict-prototypes "$@" "$file" ||
                fail "$compiler -std=$standard $file"
        done
    done
    for compiler in c++ clang++; do
        command -v $compiler >/dev/null || continue
        $compiler -x c++ -std=c++17 "${strict[@]}" "$@" "$file" || fail "$compiler -std=c++17 $file"
    done
}

# moved AT_LEAST_MM FILE: perform printed into FILE that a vertex moved so far.
moved() {
    local mm
    mm=$(fact moved "$2")
    awk -v a="${mm:-0}" -v b="$1" 'BEGIN { exit !(a >= b) }' || fail "moved ${mm:-nothing} mm, not $1: $2"
}
