#!/usr/bin/env bash
# The contract compiles alone, without a warning, as C11, C17 and C++17.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
echo '#include <marotte/plugin.h>' >"$folder/plugin.c"
for standard in c11 c17; do
    cc -std=$standard -Wall -Wextra -Wpedantic -Wstrict-prototypes -Werror \
        -I"$SOURCE_DIR/core/include" -fsyntax-only "$folder/plugin.c"
done
c++ -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror \
    -I"$SOURCE_DIR/core/include" -fsyntax-only "$folder/plugin.c"
