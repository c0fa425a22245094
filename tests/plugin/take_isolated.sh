#!/usr/bin/env bash
# Takes with mappings that did not come with marotte: a crash of one takes nothing along, is told, and
# what was recorded is kept.
source "${SOURCE_DIR:?}/tests/plugin/lib.sh" || exit 1
troubled=$BUILD_DIR/tests/plugin/troubled.so
hands="log:$demo,start=1,end=3"
show=$scratch/a.marotte
mkdir -p "$XDG_DATA_HOME" "$scratch/mine"
cp "$troubled" "$scratch/mine/troubled.so"

# ended NAME STATUS WORDS: how the command ended whose words are in $scratch/NAME.
ended() {
    [ "$2" -eq 1 ] || fail "$1: exit $2, not 1: $(cat "$scratch/$1")"
    grep -q "$3" "$scratch/$1" || fail "$1: \"$3\" is not said: $(cat "$scratch/$1")"
}
takes() { "$MAROTTE" take list "$show" --json | sed -nE 's/^ *"take_count": ([0-9]+),?$/\1/p'; }
is_whole() { "$MAROTTE" take check "$show" --json >"$scratch/said" 2>&1 || fail "check: $(cat "$scratch/said")"; }

"$MAROTTE" perform --face moai --input "$hands" --map anchored --calibration none --record "$show" \
    >"$scratch/said" 2>&1 || fail "perform: $(cat "$scratch/said")"

# ---- performed over: it runs apart ----
"$MAROTTE" take record "$show" 1 --input "$hands" --map "$troubled" --calibration none \
    >"$scratch/over" 2>&1 || fail "record: $(cat "$scratch/over")"
grep -q "^isolated" "$scratch/over" || fail "record runs it in the program: $(cat "$scratch/over")"
[ "$(takes)" = 2 ] || fail "there are $(takes) takes"

# ---- crashes while it performs over a take: told, and what came before is kept ----
"$MAROTTE" take record "$show" 1 --input "$hands" --map "$troubled,trouble=crash" --calibration none \
    >"$scratch/crash" 2>&1
ended crash $? ": mapping org.example.troubled was ended by signal 11"
[ "$(takes)" = 3 ] || fail "what was recorded before the crash is no take: $(takes)"
[ "$(fact "samples performed" "$scratch/crash")" -ge 1 ] || fail "no sample is kept: $(cat "$scratch/crash")"
is_whole

# In life's pace the face is held, and every sample is recorded.
"$MAROTTE" take record "$show" 1 --input "$hands,speed=4" --map "$troubled,trouble=crash" \
    --calibration none --realtime >"$scratch/live" 2>&1 || fail "record: $(cat "$scratch/live")"
grep -q "was ended by signal 11" "$scratch/live" || fail "live: the crash is not told: $(cat "$scratch/live")"
[ "$(fact "samples performed" "$scratch/live")" -ge 200 ] || fail "live: samples are lost: $(cat "$scratch/live")"
[ "$(takes)" = 4 ] || fail "live: there are $(takes) takes"
"$MAROTTE" take undo "$show" 1 --steps 99 >/dev/null 2>&1 # the take by itself again

# ---- performed anew: apart too ----
MAROTTE_PLUGINHOST=/nowhere "$MAROTTE" take remap "$show" 1 --map "$troubled" >"$scratch/apart" 2>&1
ended apart $? 'MAROTTE_PLUGINHOST names "/nowhere"'
[ "$(takes)" = 4 ] || fail "apart: a take is left"
export MAROTTE_PLUGIN_PATH=$scratch/mine
"$MAROTTE" take remap "$show" 1 --map troubled >"$scratch/anew" 2>&1 || fail "remap: $(cat "$scratch/anew")"
grep -q "^face .*max [0-9.]* mm" "$scratch/anew" || fail "remap tells no mm: $(cat "$scratch/anew")"
"$MAROTTE" take remap "$show" 1 --map troubled,trouble=crash >"$scratch/anew" 2>&1
grep -q "note: the two takes are not compared: mapping org.example.troubled was ended by signal 11" "$scratch/anew" ||
    fail "remap: the crash is not told: $(cat "$scratch/anew")"
[ "$(takes)" = 6 ] || fail "remap: there are $(takes) takes"
is_whole

# ---- a take whose mapping crashes is not exported as if it had not ----
"$MAROTTE" take export "$show" last --export "$scratch/last.csv" >"$scratch/export" 2>&1
ended export $? ": mapping org.example.troubled was ended by signal 11"
[ ! -e "$scratch/last.csv" ] || fail "a crashed export leaves a file"
finish
