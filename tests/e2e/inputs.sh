#!/usr/bin/env bash
# Faders and a phone perform by a patch, live; the take performs again bit for bit, its raw channels
# perform the same face through a log, and another patch changes it afterwards.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1

# A performance hears the whole movement, however long it takes to begin: its sender sends again and again.
perform() { # input patch show sender
    "$MAROTTE" perform --verbose --face "$puppet" --seconds 2 --input "$1" --map one_hand --patch "$2" --record "$3" \
        >said 2>stderr &
    local performing=$!
    while kill -0 $performing 2>/dev/null; do "$4" 2>/dev/null; done
    wait $performing || fail "perform --input $1: $(cat stderr)"
}
# again NAME PATCH: the take of NAME.marotte against itself and against its own raw channels.
again() {
    local name=$1 patch=$2
    "$MAROTTE" take export "$name.marotte" last --export "$name.pc2" >said 2>stderr || fail "$name: $(cat stderr)"
    [ "$(fact 'range of motion' said)" != 0.00 ] || fail "$name moves nothing"
    "$MAROTTE" take export "$name.marotte" last --export again.pc2 >said 2>stderr || fail "$name: $(cat stderr)"
    cmp -s "$name.pc2" again.pc2 || fail "$name: the take performs otherwise the second time"
    "$MAROTTE" take log "$name.marotte" last --out "$name.csv" >said 2>stderr || fail "$name: $(cat stderr)"
    "$MAROTTE" perform --verbose --face "$puppet" --input "log:$name.csv" --map one_hand --patch "$patch" --export log.pc2 \
        >said 2>stderr || fail "$name: $(cat stderr)"
    # the same frames after the header; one may have a frame more at its end
    local size
    size=$(stat -c %s "$name.pc2" log.pc2 | sort -n | head -n 1)
    cmp -i 32 -n $((size - 32)) "$name.pc2" log.pc2 || fail "$name: its raw channels perform another face"
    first=$(sha256sum <"$name.pc2")
    "$MAROTTE" take remap "$name.marotte" last --patch half.json >said 2>stderr || fail "$name: $(cat stderr)"
    "$MAROTTE" take export "$name.marotte" last --export half.pc2 >said 2>stderr || fail "$name: $(cat stderr)"
    [ "$(sha256sum <half.pc2)" != "$first" ] || fail "$name: another patch changes nothing"
}
patch_of() { # file channel most
    printf '{"marotte_patch": 1, "name": "test", "connections": [
        {"from": {"channel": "%s"}, "to": {"dof": "jaw.open"}, "out": [0, %s]},
        {"from": {"channel": "browInnerUp"}, "to": {"contact": "brow.mid.*"}, "out": [0, 8]}]}\n' "$2" "$3" >"$1"
}

# MIDI through a pipe: a fader up and down.
mkfifo pipe
patch_of full.json cc.7 0.5
patch_of half.json cc.7 0.25
move_fader() {
    for v in 00 10 20 30 40 50 60 70 7f 70 60 50 40 30 20 10 00 20 40 60 7f; do
        printf "\xb0\x07\x$v" >&3
        sleep 0.05
    done
}
exec 3<>pipe
perform midi:./pipe full.json midi.marotte move_fader
exec 3>&-
again midi full.json
head -n 3 midi.csv | grep -q ',cc.7,' || fail "the fader has lost its name: $(head -n 2 midi.csv)"

# The voice through a pipe: louder and softer.
mkfifo sound
patch_of full.json level 0.5
patch_of half.json level 0.25
for amplitude in 4 20 120; do # 80 ms of a buzz of that many 1/128 of full scale
    period=$(awk -v a="$amplitude" 'BEGIN { for (i = 0; i < 96; ++i) printf "\\x00\\x%02x", i < 48 ? a : 256 - a }')
    # shellcheck disable=SC2059
    for _ in $(seq 40); do printf "$period"; done >"buzz.$amplitude"
done
speak() {
    for amplitude in 4 20 120 20 120 4 120 20 4; do
        timeout 1 cat "buzz.$amplitude" >&3 # nobody reads any more when the performance has just ended: the pipe is full
        sleep 0.08
    done
}
exec 3<>sound
perform voice:./sound full.json voice.marotte speak
exec 3>&-
again voice full.json

# A phone: iFacialMocap's text.
port=$((20000 + $$ % 10000))
patch_of full.json jawOpen 0.5
patch_of half.json jawOpen 0.25
move_face() {
    for v in 0 20 40 60 80 100 80 60 40 20 0 30 60 90; do
        printf 'jawOpen&%d|browInnerUp&%d|trackingStatus&1|=head#0,0,0,0,0,0|' "$v" "$((100 - v))" \
            >"/dev/udp/127.0.0.1/$port"
        sleep 0.05
    done
}
perform "phone:$port" full.json phone.marotte move_face
again phone full.json
refused 1 'is not a port' "$MAROTTE" perform --face "$puppet" --map one_hand --input phone:waldo
refused 1 'plug it in' "$MAROTTE" perform --face "$puppet" --map one_hand --input midi:/dev/snd/nowhere
refused 1 'plug' "$MAROTTE" perform --face "$puppet" --map one_hand --input gamepad:7

# A port in use is one calm line.
"$MAROTTE" perform --face "$puppet" --map one_hand --input "phone:$port" >/dev/null 2>&1 &
holder=$!
for _ in $(seq 600); do
    grep -qi ":$(printf %04x "$port") " /proc/net/udp && break
    sleep 0.1
done
refused 1 'another program' "$MAROTTE" perform --face "$puppet" --map one_hand --input "phone:$port"
kill -INT $holder
wait $holder
finish
