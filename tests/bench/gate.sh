#!/usr/bin/env bash
# The ratios that the engine is promised to reach: none may be less than half of it. They are of one
# run each, and the machine may have other work: one run of three is enough. A quick run takes less than 30 s of a processor.
source "$(dirname "$0")/../e2e/lib.sh"
seconds_max=30
case "${BUILD_TYPE:-}" in
Release | RelWithDebInfo) ;;
*) echo "SKIPPED: ratios are promised for release builds; this is ${BUILD_TYPE:-an unknown build}" && exit 77 ;;
esac
[ -z "${SANITIZED:-}" ] || { echo "SKIPPED: ratios are not promised under a sanitizer"; exit 77; }

TIMEFORMAT='%U %S'
for try in 1 2 3; do
    { time "$MAROTTE" bench --quick --gate >"$scratch/said" 2>"$scratch/errors"; } 2>"$scratch/took"
    code=$?
    sed -n '/What is promised/,$p' "$scratch/said"
    [ $code -ne 0 ] || break
    echo "try $try: $(cat "$scratch/errors")"
done
[ $code -eq 0 ] || fail "exit $code three times"
[ "$(grep -c promised "$scratch/said")" -ge 10 ] || fail "it does not say what is promised"
took=$(awk '{ printf "%d\n", $1 + $2 }' "$scratch/took")
[ "$took" -lt $seconds_max ] || fail "a quick run took $took s of a processor, not $seconds_max"
echo "a quick run: $took s of a processor"
finish
