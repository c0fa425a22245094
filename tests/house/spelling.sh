#!/usr/bin/env bash
# codespell knows no misspelling in the sources, the guides and the package. Right, although it knows better: names of functions and
# libraries (te, ue, nd, datas, inout, fro, bu, lates), and what tests of suggestions mistype.
set -u
cd "$SOURCE_DIR" || exit 1
command -v codespell >/dev/null || { echo "SKIPPED: codespell is not installed (package codespell)"; exit 77; }
mapfile -t files < <(find .ci .github core debian plugins rigs tests ui run test ./*.md CMakeLists.txt -type f \
    -not -path '*/node_modules/*' -not -path '*/seeds/*' -not -path 'tests/take/golden/*' -not -name '*.csv' -not -name package-lock.json \
    -exec grep -Il . {} +)
[ ${#files[@]} -gt 1000 ] || { echo "only ${#files[@]} files were found: the search is broken"; exit 1; }
codespell --ignore-words-list te,ue,nd,datas,inout,fro,bu,lates,lits,perfrom,nwe,exprot -- "${files[@]}" || exit 1
echo "${#files[@]} files"
