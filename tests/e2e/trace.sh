#!/usr/bin/env bash
# MAROTTE_LOG prints what the chosen rooms do, with times, on stderr; an unknown room is an error that lists the rooms.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
perform() { "$MAROTTE" perform --face puppet --input log:demo_hand.csv,end=1 --map one_hand --record take.marotte --export take.csv; }

MAROTTE_LOG=input,show perform >out.txt 2>trace.txt || fail "perform: $(cat trace.txt)"
grep -qE '^[0-9]+\.[0-9]{6} [0-9]+ input: .*demo_hand.csv.*: opened with [0-9]+ channels$' trace.txt || fail "no line about the input"
grep -qE ' show: commit: done$' trace.txt || fail "no line about the show"
! grep -qE ' (io|record|mapping): ' trace.txt || fail "lines of rooms that were not chosen"

MAROTTE_LOG=all perform >out.txt 2>trace.txt || fail "perform: $(cat trace.txt)"
for room in input io record show mapping; do
    grep -qE "^[0-9.]+ [0-9]+ $room: " trace.txt || fail "no line of $room"
done
perform >out.txt 2>trace.txt
[ ! -s trace.txt ] || ! grep -qE '^[0-9.]+ [0-9]+ [a-z]+: ' trace.txt || fail "lines without MAROTTE_LOG"

MAROTTE_LOG=input,shw perform >out.txt 2>trace.txt
[ $? -eq 2 ] || fail "an unknown room: exit code"
grep -q 'unknown room "shw"; choose among all, input, mapping' trace.txt || fail "an unknown room: $(cat trace.txt)"
finish
