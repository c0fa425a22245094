#!/usr/bin/env bash
# take mouth: a voice moves the mouth of a take, as a layer that is edited, undone, exported and replayed
# bit for bit, and of a take that has only a voice; what is no voice is refused. Without pocketsphinx the
# mouth follows the spectrum alone, so this needs no package.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
voice=$SOURCE_DIR/plugins/log/demo.ogg
show=$scratch/show.marotte

# ---- below the hand of a take ----
"$MAROTTE" perform --face "$puppet" --input "log:$demo,end=4" --map one_hand --record "$show" >out.txt 2>&1 ||
    fail "perform: $(cat out.txt)"
refused 1 "has no sound" "$MAROTTE" take mouth "$show" last
"$MAROTTE" take audio attach "$show" last "$voice" --offset -1.5 >/dev/null || fail "attach"
before=$("$MAROTTE" take show "$show" last --hash --fps 30 2>/dev/null | sed -n 's/^SHA-256 *//p')
"$MAROTTE" take mouth "$show" last --json --out sounds.csv >facts.json 2>stderr || fail "take mouth: $(cat stderr)"
grep -q '"sounds": [1-9]' facts.json || fail "no sounds: $(cat facts.json)"
awk -F, 'NR == 1 { exit $0 != "start_s,end_s,sound" } $2 < $1 { exit 1 }' sounds.csv || fail "sounds.csv: $(head -3 sounds.csv)"
"$MAROTTE" take show "$show" last >said 2>&1
grep -q "^layer [0-9]* *'voice mouth'" said || fail "no layer: $(cat said)"
grep "^layer" said | head -n 1 | grep -q "voice mouth" || fail "it is not the lowest: $(cat said)"
[ "$(grep -c "^layer.*additive" said)" -ge 1 ] || fail "the hand does not add: $(cat said)"
sum() { "$MAROTTE" take show "$show" last --hash --fps 30 2>/dev/null | sed -n 's/^SHA-256 *//p'; }
first=$(sum)
[ -n "$first" ] && [ "$first" != "$before" ] || fail "the mouth does not move"
[ "$(sum)" = "$first" ] || fail "a replay has other bits"
for isa in generic v2; do
    found=$(MAROTTE_ISA=$isa "$MAROTTE" take show "$show" last --hash --fps 30 2>isa.txt | sed -n 's/^SHA-256 *//p')
    [ "$found" = "$first" ] || grep -q MAROTTE_ISA isa.txt || fail "$isa has other bits"
done
# From its middle on, as after scrubbing: the same rows.
"$MAROTTE" take export "$show" last --export whole.csv --fps 30 >/dev/null 2>&1 || fail "export"
"$MAROTTE" take export "$show" last --export part.csv --fps 30 --in 2 >/dev/null 2>&1 || fail "export of a part"
tail -n 20 whole.csv | cut -d, -f 4- >a.txt
tail -n 20 part.csv | cut -d, -f 4- >b.txt
cmp -s a.txt b.txt || fail "a part has other values: $(diff a.txt b.txt | head -3)"
# Again: replaced, not doubled. Each run is one step of undo.
"$MAROTTE" take mouth "$show" last --jaw 0.3 --lips 0.5 >/dev/null 2>stderr || fail "again: $(cat stderr)"
"$MAROTTE" take show "$show" last >said 2>&1
[ "$(grep -c "voice mouth" said)" -eq 1 ] || fail "doubled: $(cat said)"
[ "$(sum)" != "$first" ] || fail "--jaw and --lips change nothing"
"$MAROTTE" take undo "$show" last >/dev/null || fail "undo"
[ "$(sum)" = "$first" ] || fail "undo of the second run"
"$MAROTTE" take undo "$show" last >/dev/null || fail "undo"
[ "$(sum)" = "$before" ] || fail "undo of the first run"
"$MAROTTE" take redo "$show" last >/dev/null || fail "redo"
[ "$(sum)" = "$first" ] || fail "redo"
"$MAROTTE" take layer additive "$show" last 1 --off >/dev/null 2>&1 || fail "the hand replaces again"
"$MAROTTE" take check "$show" >said 2>&1 || fail "check: $(cat said)"

# ---- a voice alone ----
"$MAROTTE" take export "$show" last --export line.wav >/dev/null 2>&1 || fail "export of the sound"
"$MAROTTE" take mouth new.marotte --sound line.wav --face puppet --words "hello marotte" >said 2>&1 ||
    fail "a voice alone: $(cat said)"
"$MAROTTE" take export new.marotte last --export new.csv --export new.wav >said 2>&1 || fail "its export: $(cat said)"
MAROTTE_SPEECH_MODEL=/nowhere "$MAROTTE" take mouth new.marotte last >said 2>&1 || fail "without a model: $(cat said)"
grep -q "coarser" said || fail "nothing is said about the coarser mouth: $(cat said)"

# ---- what cannot be ----
refused 2 "either a TAKE or --sound" "$MAROTTE" take mouth "$show"
refused 2 "--sound needs --face" "$MAROTTE" take mouth none.marotte --sound line.wav
[ ! -e none.marotte ] || fail "a show was made for nothing"
refused 2 "either --words or --words-file" "$MAROTTE" take mouth "$show" last --words a --words-file b
refused 2 "--jaw" "$MAROTTE" take mouth "$show" last --jaw 9
refused 1 "no English word" "$MAROTTE" take mouth "$show" last --words "..."
printf '%70000s' x >long.txt
refused 1 "long.txt" "$MAROTTE" take mouth "$show" last --words-file long.txt
refused 1 "has no pose \"viseme_PP\"" "$MAROTTE" take mouth plain.marotte --sound line.wav --face "$SOURCE_DIR/rigs/puppet/puppet.glb"
tone() { # LOUDNESS: a WAV of 2 s at 8 kHz, 8 bits
    printf 'RIFF\244\076\000\000WAVEfmt \020\000\000\000\001\000\001\000\100\037\000\000\100\037\000\000\001\000\010\000data\200\076\000\000'
    awk -v loud="$1" 'BEGIN { for (i = 0; i < 16000; ++i) printf "%c", 128 + int(loud * sin(i * 0.3)) }' | head -c 16000
}
LC_ALL=C tone 0 >silence.wav
LC_ALL=C tone 60 >tone.wav
refused 1 "is silent" "$MAROTTE" take mouth silent.marotte --sound silence.wav --face puppet
refused 1 "no speech was found" "$MAROTTE" take mouth tone.marotte --sound tone.wav --face puppet
finish
