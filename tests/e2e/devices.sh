#!/usr/bin/env bash
# marotte devices, and a performance with a device that goes away: with the flaky device of the
# tests in place of hardware.
source "$(dirname "$0")/lib.sh"
mkdir "$scratch/plugins"
cp "$BUILD_DIR/tests/plugin/flaky.so" "$scratch/plugins/" || fail "flaky.so is not built"
export MAROTTE_PLUGIN_PATH=$scratch/plugins

said() { grep -qF -- "$1" "$2" || fail "\"$1\" is not said: $(cat "$2")"; }

# What is plugged in, and what to do about it.
"$MAROTTE" devices >"$scratch/list.txt" || fail "devices"
said "ready    Flaky glove" "$scratch/list.txt"
said "--input flaky:port:1-2" "$scratch/list.txt"
said "sudo usermod" "$scratch/list.txt"
"$MAROTTE" devices --json >"$scratch/list.json" || fail "devices --json"
said '"input": "flaky:port:1-2"' "$scratch/list.json"
said '"state": "denied"' "$scratch/list.json"
MAROTTE_FLAKY=$scratch/no "$MAROTTE" devices >"$scratch/none.txt" || fail "devices without any"
grep -q "A device that goes away" "$scratch/none.txt" ||
    grep -q "ready\|denied\|busy\|unsure" "$scratch/none.txt" || fail "nobody says what was looked for"
grep -q '^  log ' "$scratch/none.txt" && fail "the log has no devices"

# How it is doing: a line a second, comes and goes.
until_said() { # WORDS FILE PID: waits for the words, or for the end of the process. FILE is new: the process makes it
    until grep -qsF -- "$1" "$2" || ! kill -0 "$3" 2>/dev/null; do sleep 0.1; done
}
"$MAROTTE" devices --watch --seconds 120 --input flaky:a,run=0.6,tries=2,losses=1 \
    --input flaky:b >"$scratch/watch.txt" 2>"$scratch/news.txt" &
watcher=$!
until_said "flaky a came back at" "$scratch/news.txt" $watcher
until_said "went away 1x" "$scratch/watch.txt" $watcher
kill -INT $watcher
wait $watcher || fail "devices --watch"
said "flaky b " "$scratch/watch.txt"
said "Hz  jitter" "$scratch/watch.txt"
said "went away 1x" "$scratch/watch.txt"
grep -Eq 'flaky a went away at (0\.[6-9]|[1-9][0-9]*\.[0-9]) s \(flaky a: the cable was pulled\)' "$scratch/news.txt" ||
    fail "the loss is not told"
said "flaky a came back at" "$scratch/news.txt"
[ "$(grep -c 'no such device' "$scratch/news.txt")" -eq 1 ] || fail "said again and again"
"$MAROTTE" devices --watch --seconds 0.5 --json --input flaky:a >"$scratch/watch.json" ||
    fail "devices --watch --json"
said '"state":"running"' "$scratch/watch.json"
"$MAROTTE" devices --watch --seconds 120 --input "log:$demo,end=0.3" >"$scratch/log.txt" ||
    fail "watching a recording"
said "over" "$scratch/log.txt"

# In place on a terminal: the lines are written over.
if command -v script >/dev/null; then
    for seconds in 1.2 6 30; do # however busy the machine
        script -qec "$MAROTTE devices --watch --seconds $seconds --input flaky:a" /dev/null \
            >"$scratch/terminal.txt" || fail "devices --watch on a terminal"
        in_place=$(grep -c $'\033\[1A' "$scratch/terminal.txt")
        [ "$in_place" -ge 3 ] && break
    done
    [ "$in_place" -ge 3 ] || fail "not in place"
fi

# Ctrl-C ends it at once, and is no failure, also while a device takes long to open.
rm "$scratch/news.txt"
"$MAROTTE" devices --watch --input flaky:a,run=0.1,open=100 >/dev/null 2>"$scratch/news.txt" &
watcher=$!
until_said "flaky a went away" "$scratch/news.txt" $watcher
before=$SECONDS
kill -INT $watcher
wait $watcher || fail "Ctrl-C: exit $?"
[ $((SECONDS - before)) -lt 60 ] || fail "Ctrl-C waited for the device, which takes 100 s"

# What is plugged in later is found.
rm "$scratch/news.txt"
MAROTTE_FLAKY=$scratch/later "$MAROTTE" devices --watch --seconds 60 >"$scratch/later.txt" \
    2>"$scratch/news.txt" &
watcher=$!
until_said "waiting for one" "$scratch/news.txt" $watcher
touch "$scratch/later"
until_said "flaky port:1-2               running" "$scratch/later.txt" $watcher
kill -INT $watcher
wait $watcher || fail "waiting for a device: exit $?"
said "note: no device is ready: waiting for one" "$scratch/news.txt"
said "flaky port:1-2               running" "$scratch/later.txt"

# Learning a switch.
"$MAROTTE" devices --learn flaky:pedal >"$scratch/learn.txt" || fail "devices --learn"
said "press switch 1" "$scratch/learn.txt"
said "done: 1 switch was stored" "$scratch/learn.txt"

# A performance goes on without its device, and says so.
for seconds in 2 8 40; do # however busy the machine
    "$MAROTTE" perform --verbose --face "$moai" --map anchored --seconds $seconds \
        --input flaky:glove,run=0.5,away=0.3,losses=1,pedal=1 \
        >"$scratch/perform.txt" 2>"$scratch/news.txt" || fail "perform with a loss"
    grep -q 'flaky glove came back' "$scratch/news.txt" && break
done
grep -Eq 'flaky glove went away at (0\.[5-9]|[1-9][0-9]*\.[0-9]) s \(.*pulled\); the pose is held' "$scratch/news.txt" ||
    fail "the loss is not told"
grep -Eq 'flaky glove came back after (0\.[3-9]|[1-9][0-9]*\.[0-9]) s' "$scratch/news.txt" || fail "not back"
[ "$(fact 'went away' "$scratch/perform.txt")" = 1 ] || fail "the loss is not counted"
[ "$(fact 'frames' "$scratch/perform.txt")" -ge 20 ] || fail "no frames while it was away"
"$MAROTTE" perform --face "$moai" --map anchored --seconds 1 --input flaky:glove,run=0.3,away=60 \
    >"$scratch/perform.txt" 2>/dev/null || fail "perform with a device that stays away"
said "warning            still away: flaky glove" "$scratch/perform.txt"

# Wrong usage and what cannot be.
refused 2 'there is no option' "$MAROTTE" devices --wach
refused 2 '--input needs --watch' "$MAROTTE" devices --input flaky:a
refused 2 '--learn cannot be combined' "$MAROTTE" devices --learn flaky --watch
refused 2 'is not a number' "$MAROTTE" devices --watch --seconds soon
MAROTTE_FLAKY=$scratch/no "$MAROTTE" devices --watch --seconds 0.1 >/dev/null 2>"$scratch/news.txt" &&
    fail "nothing was there to be watched"
said "no device is ready" "$scratch/news.txt"
refused 1 'no such device: plug it in' "$MAROTTE" devices --watch --input flaky:a,fail=1
refused 1 'not one of its choices: 115200, 57600' "$MAROTTE" devices --watch --input cyberglove:x,baud=12
refused 1 'there is no input plugin "waldo"' "$MAROTTE" devices --watch --input waldo
refused 1 'has no parameter "learn"' "$MAROTTE" devices --learn "log:$demo"
refused 1 'no such device: plug it in' "$MAROTTE" perform --face "$moai" --map anchored \
    --input flaky:glove,fail=1
finish
