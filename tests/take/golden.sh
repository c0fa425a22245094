#!/usr/bin/env bash
# Takes that an earlier version recorded play as they did then: the SHA-256 over all vertices of all
# frames at 30 fps is the one that was written down beside them. golden.sh --update writes it down
# anew, which is right only when a face of rigs/ has changed on purpose.
source "$(dirname "$0")/../e2e/lib.sh"
golden=$SOURCE_DIR/tests/take/golden
show=$scratch/four_takes.marotte
cp "$golden/four_takes.marotte" "$show" # reading makes files beside it
cd "$SOURCE_DIR" || exit 1              # its faces are named from here

sum_of() { # take
    "$MAROTTE" take show "$show" "$1" --hash --fps 30 2>"$scratch/stderr" |
        sed -n 's/^SHA-256 *//p'
}
sums() {
    for take in 1 2 3 4; do
        echo "$take $(sum_of "$take")"
    done
}

if [ "${1:-}" = --update ]; then
    sums >"$golden/SHA256"
    cat "$golden/SHA256"
    exit
fi
results=0 equal=0
same() { # FOUND EXPECTED
    results=$((results + 1))
    [ "$1" = "$2" ] && equal=$((equal + 1))
}
while read -r take expected; do
    found=$(sum_of "$take")
    same "$found" "$expected" ||
        fail "take $take plays otherwise: $found instead of $expected ($(grep -v performs "$scratch/stderr"))"
    ! grep -q 'The current file is used' "$scratch/stderr" ||
        fail "the face has changed: $(cat "$scratch/stderr")"
done <"$golden/SHA256"
[ "$(wc -l <"$golden/SHA256")" -eq 4 ] || fail "not four takes"
# Nor does it depend on the instruction set: those that this machine lacks are refused.
for isa in generic v2 v3 v4; do
    found=$(MAROTTE_ISA=$isa sum_of 1)
    [ -n "$found" ] || ! grep -q 'MAROTTE_ISA' "$scratch/stderr" || continue
    same "$found" "$(sed -n 's/^1 //p' "$golden/SHA256")" ||
        fail "MAROTTE_ISA=$isa: take 1 plays otherwise: $found ($(grep -v performs "$scratch/stderr"))"
done
# Nor on the number of threads.
for threads in 1 2 3; do
    found=$(MAROTTE_THREADS=$threads sum_of 1)
    same "$found" "$(sed -n 's/^1 //p' "$golden/SHA256")" ||
        fail "MAROTTE_THREADS=$threads: take 1 plays otherwise: $found ($(cat "$scratch/stderr"))"
done
if MAROTTE_THREADS=0 "$MAROTTE" --version >"$scratch/stdout" 2>"$scratch/stderr"; then
    fail "MAROTTE_THREADS=0 is taken"
fi
grep -q 'from 1 to 16' "$scratch/stderr" || fail "MAROTTE_THREADS=0: $(cat "$scratch/stderr")"
# A test that cannot fail would be none.
[ "$(sum_of 1)" != "$(sum_of 2)" ] || fail "two takes have one sum"
echo "$results results, $equal with the recorded bits"
finish
