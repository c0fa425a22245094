#!/usr/bin/env bash
# Life of a face that `perform` records: the same seed gives the same bits, and a take shows them again, also from a stored state
# and without one; an export has them; without the layer the hands are as without life. Prints the bytes that life takes in a show.
source "$(dirname "$0")/../e2e/lib.sh"
cd "$scratch" || exit 1
perform() { # life, other arguments
    "$MAROTTE" perform --face puppet --input log:demo_hand.csv,end=8 --map one_hand --life "$@" >said 2>&1 ||
        fail "perform --life $*: $(cat said)"
}
hash_of() { # show
    "$MAROTTE" take show "$1" 1 --hash --fps 30 2>said | sed -n 's/^SHA-256 *//p'
}

# ---- the same bits ----
perform seed=5 --record a.marotte --export live.pc2
perform seed=5 --record b.marotte
perform seed=6 --record c.marotte
perform off --record still.marotte
a=$(hash_of a.marotte)
[ -n "$a" ] || fail "no hash: $(cat said)"
[ "$a" = "$(hash_of b.marotte)" ] || fail "the same seed gives another life"
[ "$a" != "$(hash_of c.marotte)" ] || fail "another seed gives the same life"
[ "$a" != "$(hash_of still.marotte)" ] || fail "life moves nothing"
"$MAROTTE" take export a.marotte 1 --export again.pc2 --fps 30 >said 2>&1 || fail "export: $(cat said)"
cmp -s live.pc2 again.pc2 || fail "the export differs from the performance"

# ---- a layer of its own ----
"$MAROTTE" take show a.marotte 1 >said
grep -q "'life', owns all, gain 1, additive" said || fail "no layer of life: $(cat said)"
layer=$(sed -n "s/^layer \([0-9]*\) *'life'.*/\1/p" said)
"$MAROTTE" take layer mute a.marotte 1 "$layer" >said 2>&1 || fail "mute: $(cat said)"
[ "$(hash_of a.marotte)" = "$(hash_of still.marotte)" ] || fail "a muted life still moves the face, or changed the hands"
"$MAROTTE" take undo a.marotte 1 >said 2>&1 || fail "undo: $(cat said)"
[ "$(hash_of a.marotte)" = "$a" ] || fail "undo gives another life"

# ---- its part alone, from states and without them ----
if command -v sqlite3 >/dev/null; then
    [ "$(sqlite3 a.marotte 'SELECT COUNT(*) > 0 FROM checkpoint')" = 1 ] || fail "no state was stored"
    "$MAROTTE" take export a.marotte 1 --export from.pc2 --fps 30 --in 6.5 --out 7.5 >said 2>&1 || fail "export: $(cat said)"
    sqlite3 a.marotte 'DELETE FROM checkpoint'
    "$MAROTTE" take export a.marotte 1 --export played.pc2 --fps 30 --in 6.5 --out 7.5 >said 2>&1 || fail "export: $(cat said)"
    cmp -s from.pc2 played.pc2 || fail "a stored state gives another life"
    "$MAROTTE" perform --face puppet --life seed=5 --seconds 60 --fps 1 --record alone.marotte >said 2>&1 ||
        fail "life alone: $(cat said)"
    for show in a alone; do
        sqlite3 $show.marotte "SELECT '$show: ' || CAST(SUM(LENGTH(c.bytes)) * 60e9 / (MAX(c.to_ns) - MIN(c.from_ns)) AS INTEGER) ||
            ' bytes of life a minute' FROM chunk c JOIN track t ON t.id = c.track JOIN plugin p ON p.id = t.plugin
            WHERE p.identity LIKE 'org.marotte.life %'"
    done
    bytes=$(sqlite3 alone.marotte 'SELECT SUM(LENGTH(bytes)) FROM chunk')
    [ "$bytes" -lt 20000 ] || fail "life alone takes $bytes bytes a minute"
fi

# ---- odd faces and wrong words ----
not_taken() { # sentence, arguments
    local sentence=$1
    shift
    "$MAROTTE" perform --face puppet "$@" >said 2>&1 && fail "$*: is taken"
    grep -qF "$sentence" said || fail "$*: $(cat said)"
}
not_taken 'no end: add --seconds N' --life on
not_taken 'Did you mean "blink"?' --life blnk=0.5 --seconds 1
not_taken 'is outside 0 .. 1' --life blink=2 --seconds 1
not_taken 'seed="soon" is not a number' --life seed=soon --seconds 1
"$MAROTTE" perform --face moai --life on --seconds 1 --fps 1 >said 2>&1 || fail "moai: $(cat said)"
finish
