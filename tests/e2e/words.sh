#!/usr/bin/env bash
# The command line as a stranger types it: wrong words get the right one, outputs get their folders, what comes along is
# found by its name, help is where it is looked for, and a performance is told in four lines.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
cp "$moai" girl.glb
one_second=(--face puppet --input "log:demo_hand.csv,start=12,end=13" --map one_hand)

# ---- Did you mean ----
refused 1 'there is no face "pupet". Did you mean "puppet"? Installed: moai, puppet' \
    "$MAROTTE" perform --face pupet --input log:demo_hand.csv --map one_hand
refused 1 'Did you mean "girl.glb"?' "$MAROTTE" perform --face gril.glb --input log:demo_hand.csv --map anchored
refused 1 'demo_hnad: No such file or directory. Did you mean "demo_hand"?' \
    "$MAROTTE" perform --face puppet --input log:demo_hnad --map one_hand
mkdir recordings && cp "$demo" recordings/mine.csv
refused 1 'Did you mean "recordings/mine.csv"?' "$MAROTTE" perform --face puppet --input log:recordings/mien.csv --map one_hand
refused 1 'there is no input plugin "lgo". Did you mean "log"?' "$MAROTTE" perform --face puppet --input lgo:x --map one_hand
refused 1 'there is no input plugin "one_hand": the plugin of this name is of another kind' \
    "$MAROTTE" perform --face puppet --input one_hand --map one_hand
refused 1 'there is no mapping plugin "onehand". Did you mean "one_hand"?' \
    "$MAROTTE" perform --face puppet --input log:demo_hand.csv --map onehand
refused 1 'there is no face output plugin "vmcc". Did you mean "vmc"?' "$MAROTTE" perform "${one_second[@]}" --output vmcc
refused 1 'has no parameter "smile_gian". Did you mean "smile_gain"?' \
    "$MAROTTE" perform --face puppet --input log:demo_hand.csv --map one_hand,smile_gian=3
refused 1 'has no parameter "zzzz". Its parameters: marotte plugin list --params' \
    "$MAROTTE" perform --face puppet --input log:demo_hand.csv --map one_hand,zzzz=3
refused 1 'there is no patch "fader". Did you mean "faders"?' "$MAROTTE" perform "${one_second[@]}" --patch fader
refused 2 'there is no option "--exprot=a.glb". Did you mean "--export"?' "$MAROTTE" perform --exprot=a.glb
refused 2 'there is no command or file "perfrom". Did you mean "perform"?' "$MAROTTE" perfrom
refused 2 'there is no command "take lits". Did you mean "list"?' "$MAROTTE" take lits s.marotte
refused 2 'there is no command "take layer ad". Did you mean "layer add"?' "$MAROTTE" take layer ad s.marotte 1 x
refused 2 'there is no command "rig nwe". Did you mean "new"?' "$MAROTTE" rig nwe girl.glb

# ---- files that are no commands ----
refused 2 'there is no command or file "gril.glb". Did you mean "girl.glb"?' "$MAROTTE" gril.glb
printf 'Dear marotte' >letter.txt
refused 2 'cannot open "letter.txt"' "$MAROTTE" letter.txt
opened() { # words, what is opened: by a stage without a window
    local words=$1
    shift
    "$MAROTTE" "$@" --hidden --script look.txt --json >said 2>stderr || { fail "$*: $(cat stderr)"; return; }
    grep -q "$words" said || fail "$* does not open it: $(cat said stderr)"
}
echo 'frames 3' >look.txt
if "$MAROTTE" --hidden --script look.txt >said 2>stderr; then
    cp "$(dirname "$puppet")"/puppet.{rig.json,glb} .
    for file in girl.glb puppet.rig.json new.marotte "$demo"; do opened '"frames"' "$file"; done
    [ -s new.marotte ] || fail "a show that is named is not created"
else
    echo "SKIPPED: no stage without a window: $(cat stderr)"
fi

# ---- folders are made, by all who write ----
"$MAROTTE" perform "${one_second[@]}" --export out/new/x.glb --export out/frames/here/ --size 64x64 \
    --record shows/deep/s.marotte >said 2>stderr || fail "perform: $(cat stderr)"
for file in out/new/x.glb out/frames/here/00001.png shows/deep/s.marotte; do [ -s $file ] || fail "$file is not there"; done
show=shows/deep/s.marotte
written() { # FILE COMMAND...
    local file=$1
    shift
    "$MAROTTE" "$@" >said2 2>stderr || fail "$*: $(cat stderr)"
    [ -s "$file" ] || fail "$* writes no $file"
}
written out/a/t.csv take export $show 1 --export out/a/t.csv
written out/b/t.csv take log $show 1 --out out/b/t.csv
written out/c/t.csv take diff $show 1 1 --csv out/c/t.csv
written out/d/t.marotte take recover $show --out out/d/t.marotte
written out/e/girl.rig.json rig new girl.glb --out out/e/girl.rig.json
written out/f/rig.png rig show puppet --out out/f/rig.png
written out/g/s-1.pc2 take export $show --all --export 'out/g/{show}-{take}.pc2'
written out/h/wave/wave.c plugin new wave --mapping --dir out/h

# ---- four lines ----
[ "$(grep -c . said)" -eq 6 ] || fail "six lines for three files: $(cat said)"
grep -q '^performed  *puppet.rig.json: log demo_hand.csv, one_hand: 1.0 s, 31 frames$' said || fail "performed: $(cat said)"
grep -qE '^moved  *[0-9.]+ mm at most$' said || fail "moved: $(cat said)"
grep -q '^wrote  *out/new/x.glb - open it in Blender: File > Import > glTF' said || fail "what opens it: $(cat said)"
grep -q '^wrote  *shows/deep/s.marotte, take 1 - open it in the stage: marotte shows/deep/s.marotte$' said || fail "show: $(cat said)"
grep -q '^warnings  *none$' said || fail "warnings: $(cat said)"
"$MAROTTE" perform "${one_second[@]}" >said 2>stderr || fail "$(cat stderr)"
[ "$(grep -c . said)" -eq 4 ] || fail "not four lines: $(cat said)"
grep -q '^wrote  *nothing' said || fail "nothing was written: $(cat said)"
"$MAROTTE" perform "${one_second[@]}" --verbose >said 2>stderr || fail "$(cat stderr)"
for word in moved 'median frame' 'greatest stretch' penetration; do grep -q "^$word" said || fail "--verbose has no $word"; done

# ---- help ----
helps() { # WORDS COMMAND...
    local words=$1
    shift
    "$MAROTTE" "$@" >said || fail "$*"
    grep -q -- "$words" said || fail "$* does not say \"$words\""
}
helps '--export FILE' help perform
helps '--in T' help take trim
helps '--own NAMES' help take layer add
helps 'trim SHOW TAKE' help take
helps 'help COMMAND' help
refused 2 'Did you mean "perform"?' "$MAROTTE" help perfrom
refused 2 'Did you mean "trim"?' "$MAROTTE" help take trmi
finish
