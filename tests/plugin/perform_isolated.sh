#!/usr/bin/env bash
# A mapping in a process of its own, as people use it: by default for those that did not come with
# marotte; killed while it is recorded; rebuilt while it performs. KILLS=200: more kills.
source "${SOURCE_DIR:?}/tests/plugin/lib.sh" || exit 1
troubled=$BUILD_DIR/tests/plugin/troubled.so
later=$BUILD_DIR/tests/plugin/troubled_later.so
mkdir -p "$XDG_DATA_HOME"
hands="log:$demo,end=4"

# performs NAME ARGUMENTS...: facts in $scratch/NAME, what is said beside it.
performs() {
    local name=$1
    shift
    timeout 120 "$MAROTTE" perform --verbose --face moai --calibration none "$@" \
        >"$scratch/$name" 2>"$scratch/$name.said" || fail "exit $?: $* ($(cat "$scratch/$name.said"))"
}

# ---- who is isolated, and that it makes no difference ----
for isolation in auto on off; do
    performs shipped --input "$hands" --map anchored --isolate $isolation --export "$scratch/anchored-$isolation.csv"
    grep -q "^isolated" "$scratch/shipped" && is=on || is=off
    [ "$is" = "${isolation/auto/off}" ] || fail "anchored with --isolate $isolation: $is"
    performs own --input "$hands" --map "$troubled" --isolate $isolation --export "$scratch/own-$isolation.csv"
    grep -q "^isolated" "$scratch/own" && is=on || is=off
    [ "$is" = "${isolation/auto/on}" ] || fail "a plugin of one's own with --isolate $isolation: $is"
done
for name in anchored own; do
    cmp "$scratch/$name-on.csv" "$scratch/$name-off.csv" || fail "$name: isolated, it gives other bits"
    cmp "$scratch/$name-auto.csv" "$scratch/$name-off.csv" || fail "$name: isolated, it gives other bits"
done
refused 2 '--isolate "maybe" is not auto, on or off' "$MAROTTE" perform --isolate maybe
MAROTTE_PLUGINHOST=/nowhere refused 1 'MAROTTE_PLUGINHOST names "/nowhere"' "$MAROTTE" perform \
    --face moai --input "$hands" --map "$troubled" --calibration none

# ---- offline, a mapping that fails is an error; what it saw is kept, and can be performed ----
timeout 60 "$MAROTTE" perform --verbose --face moai --input "$hands" --map "$troubled,trouble=crash" \
    --calibration none >"$scratch/stdout" 2>"$scratch/stderr" && fail "a crash offline is no error"
grep -q "was ended by signal 11" "$scratch/stderr" || fail "the crash is not told: $(cat "$scratch/stderr")"
report=$(find "$XDG_DATA_HOME/marotte/reports" -name report.txt | head -1)
[ -n "$report" ] || fail "there is no report"
[ -f "${report%report.txt}right.csv" ] || fail "the report has no hand"
performs again --input "log:${report%report.txt}right.csv" --map "$troubled" --isolate off
[ "$(fact "samples read" "$scratch/again")" -ge 1 ] || fail "the report plays nothing"

# The command in it can be copied, wherever the library lies.
odd="$scratch/it's \$(odd)"
mkdir "$odd" && cp "$troubled" "$odd/troubled.so"
find "$XDG_DATA_HOME/marotte/reports" -mindepth 1 -delete
timeout 60 "$MAROTTE" perform --verbose --face moai --input "$hands" --map "$odd/troubled.so,trouble=crash" \
    --calibration none >"$scratch/stdout" 2>"$scratch/stderr" && fail "a crash offline is no error"
report=$(find "$XDG_DATA_HOME/marotte/reports" -name report.txt | head -1)
command=$(sed -n 's/^marotte perform --face FACE /"$MAROTTE" perform --face moai /p' "$report")
[ -n "$command" ] || fail "the report has no command: $(cat "$report")"
(cd "$(dirname "$report")" && eval "$command") >"$scratch/stdout" 2>&1 || fail "$command: $(cat "$scratch/stdout")"

# ---- killed at random instants while it is recorded ----
RANDOM=8
worst=0
for ((i = 0; i < ${KILLS:-5}; ++i)); do
    rm -f "$scratch/show.marotte"
    "$MAROTTE" perform --verbose --face moai --input "$hands,speed=2" --map "$troubled" --calibration none \
        --realtime --record "$scratch/show.marotte" >"$scratch/killed" 2>"$scratch/killed.said" &
    program=$!
    child=
    while [ -z "$child" ] && kill -0 $program 2>/dev/null; do
        child=$(pgrep -P $program -f marotte-pluginhost)
    done
    # it performs once there is a show; killed before, it is a mapping that cannot be used
    while [ ! -e "$scratch/show.marotte" ] && kill -0 $program 2>/dev/null; do sleep 0.01; done
    sleep "0.$(printf %03d $((RANDOM % 500)))" # of two seconds: it performs still when it is killed
    kill -9 "$child" || fail "the child was gone"
    wait $program || fail "kill $i: exit $? ($(cat "$scratch/killed.said"))"
    grep -q "was ended by signal 9" "$scratch/killed.said" || fail "kill $i is not told"
    [ "$(fact "samples recorded" "$scratch/killed")" = 401 ] || fail "kill $i: samples are lost"
    grep -q "lost\|not recorded" "$scratch/killed" && fail "kill $i: samples are lost"
    ms=$(fact "worst frame" "$scratch/killed")
    worst=$(awk -v a="$worst" -v b="$ms" 'BEGIN { print (a > b ? a : b) }')
done
echo "$i kills; worst frame $worst ms"

# ---- rebuilt while it performs and is recorded ----
mkdir "$scratch/mine"
for speed in 1 0.25 0.05; do # until the new version was looked at before the end, however busy the machine
    rm -f "$scratch/reloaded.marotte"
    cp "$troubled" "$scratch/mine/mine.so"
    cp "$later" "$scratch/mine/next"
    (
        until [ -e "$scratch/reloaded.marotte" ]; do sleep 0.1; done
        sleep 1
        mv "$scratch/mine/next" "$scratch/mine/mine.so"
    ) &
    changing=$!
    performs reloaded --input "$hands,speed=$speed" --map "$scratch/mine/mine.so" --realtime --watch-plugins \
        --record "$scratch/reloaded.marotte"
    wait $changing
    [ "$(fact reloads "$scratch/reloaded")" = 1 ] && break
done
[ "$(fact reloads "$scratch/reloaded")" = 1 ] || fail "it was not reloaded: $(cat "$scratch/reloaded.said")"
grep -q "version 2 has taken over" "$scratch/reloaded.said" || fail "the new version is not told"
[ "$(fact "samples recorded" "$scratch/reloaded")" = 401 ] || fail "reloading lost samples"
export MAROTTE_PLUGIN_PATH=$scratch/mine
"$MAROTTE" take export "$scratch/reloaded.marotte" 1 --export "$scratch/reloaded.csv" >"$scratch/stdout" 2>&1 ||
    fail "the take cannot be played: $(cat "$scratch/stdout")"
finish
