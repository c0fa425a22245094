#!/usr/bin/env bash
# The top of the tree holds what CONTRIBUTING.md's readers expect there, and nothing that a run left behind.
set -u
cd "$SOURCE_DIR" || exit 1
if ! git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    echo "SKIPPED: no git checkout"
    exit 77
fi
expected=".ci .clang-format .clang-tidy .editorconfig .github .gitignore ARCHITECTURE.md CHANGELOG.md CMakeLists.txt
CMakePresets.json CONTRIBUTING.md LICENSE README.md core debian packaging plugins rigs run test tests ui"
failed=0
while read -r name; do
    [[ " $(tr '\n' ' ' <<<"$expected")" = *" $name "* ]] || { echo "$name is tracked at the top of the tree"; failed=1; }
done < <(git ls-files | cut -d/ -f1 | sort -u)
exit $failed
