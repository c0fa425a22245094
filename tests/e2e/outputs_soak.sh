#!/usr/bin/env bash
# outputs_soak.sh [SECONDS] [stage]: a take is performed at 150 samples a second, recorded, and sent to all outputs at once;
# `stage`: on the stage, while its window is drawn in software, and not recorded. Prints how late faces went out, how many of
# them nobody heard, memory by tenths of the time, and the processor's time of each thread. Nothing may be lost on loopback,
# memory must stay, no thread may spin. ctest runs it for a moment, ./test --long for an hour and the stage for ten minutes.
seconds=${1:-8} where=${2:-perform}
source "$(dirname "$0")/lib.sh"
grown_mb_max=2 judged_from_s=600 # of the last third: what is used for the first time takes memory, the show's 8 MB of pages too
spinning=0.5                     # of a processor; where a window is drawn, those that draw do not count
command -v python3 >/dev/null || { echo "SKIPPED: python3 is not installed"; exit 77; }
cd "$scratch" || exit 1
listeners=()
trap 'kill "${listeners[@]}" 2>/dev/null; rm -rf "$scratch"' EXIT
until_true() { # SECONDS COMMAND...
    local ends=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt $ends ] || return 1
        sleep 0.1
    done
}

# Whole faces that are heard: a VMC face ends with Apply, a face_osc one says each name once, the others are one datagram.
cat >listen.py <<'PYTHON'
import json, os, selectors, signal, socket, sys
heard, at = {}, selectors.DefaultSelector()
ports = {}
for name in ("vmc", "face_osc", "livelink", "ifacialmocap"):
    one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    one.bind(("127.0.0.1", 0))
    at.register(one, selectors.EVENT_READ, name)
    ports[name], heard[name] = one.getsockname()[1], 0
signal.signal(signal.SIGTERM, lambda *_: sys.exit())
with open("ports.new", "w") as file:
    file.write("".join(f"{name}={port}\n" for name, port in ports.items()))
os.rename("ports.new", "ports")
try:
    while True:
        for key, _ in at.select():
            data, name = key.fileobj.recv(65536), key.data
            if name == "vmc":
                heard[name] += b"/VMC/Ext/Blend/Apply" in data
            elif name == "face_osc":
                heard[name] += b"EyeBlinkLeft\0" in data
            else:
                heard[name] += len(data) > 300
finally:  # datagrams that found no room here, as the kernel counts them, were not lost by who sent them
    full = {int(line.split()[1][-4:], 16): int(line.split()[-1]) for line in list(open("/proc/net/udp"))[1:]}
    with open("heard.new", "w") as file:
        json.dump({"faces": heard, "full": {name: full.get(port, 0) for name, port in ports.items()}}, file)
    os.rename("heard.new", "heard")
PYTHON
python3 listen.py 2>listen.log &
listeners+=($!)
python3 "$SOURCE_DIR/tests/e2e/vts_server.py" vts.port vts.json 2>vts.log &
listeners+=($!)
until_true 60 test -s ports && until_true 60 test -s vts.port || { fail "nobody listens: $(cat listen.log vts.log)"; finish; }
source ./ports
to=("vmc:127.0.0.1:$vmc" "face_osc:127.0.0.1:$face_osc" "livelink:127.0.0.1:$livelink"
    "ifacialmocap:to:127.0.0.1:$ifacialmocap" "vts:127.0.0.1:$(cat vts.port)")

hand=log:$demo,loop=1,speed=1.5 # 100 samples a second, half as fast again
if [ "$where" = stage ]; then
    {
        printf '{"looks": {}, "outputs": {'
        for i in "${!to[@]}"; do printf '%s"%d": "org.marotte.%s"' "$([ "$i" -eq 0 ] || echo ', ')" "$i" "${to[$i]}"; done
        printf '}}\n'
    } >window.json
    "$MAROTTE" s.marotte --hidden --settings window.json --size 1280x720 --face "$puppet" --map one_hand --input "$hand" \
        --seconds "$seconds" --json >facts.json 2>stderr.txt &
else
    "$MAROTTE" perform --face "$puppet" --map one_hand --input "$hand" --record s.marotte --realtime --seconds "$seconds" --json \
        "${to[@]/#/--output=}" >facts.json 2>stderr.txt &
fi
program=$!
memory_mb() { awk '/^Rss:/ { print $2 / 1024 }' "/proc/$program/smaps_rollup" 2>/dev/null; }
threads() { # id, seconds of the processor, of each
    awk -v hz="$(getconf CLK_TCK)" '{ sub(/.*\) /, "", $0); print FILENAME, ($12 + $13) / hz }' "/proc/$program"/task/*/stat 2>/dev/null |
        sed -E 's|^.*/task/([0-9]+)/stat|\1|'
}
begun=$(date +%s)
is_over() { [ $(($(date +%s) - begun)) -ge "$1" ] || ! kill -0 "$program" 2>/dev/null; }
until_true $((seconds + 60)) is_over $((seconds / 10))
threads >threads.first
threads_since=$(date +%s)
for tenth in 2 3 4 5 6 7 8 9; do
    memory_mb >>memory
    until_true $((seconds + 60)) is_over $((seconds * tenth / 10))
done
memory_mb >>memory
threads >threads.last
threads_until=$(date +%s)
wait "$program" || fail "it ended with $?: $(tail -n 3 stderr.txt)"
until_true 60 test -s vts.json
sleep 0.5 # of the listener, which takes what lies in its buffers
kill "${listeners[0]}"
until_true 60 test -s heard || fail "the listener says nothing: $(cat listen.log)"

python3 - "$where" "$seconds" "$grown_mb_max" "$judged_from_s" "$spinning" "$((threads_until - threads_since))" <<'PYTHON' || failures=1
import json, sys
where, seconds, grown_most, judged_from, spinning, span = sys.argv[1], *map(float, sys.argv[2:])
facts, heard = json.load(open("facts.json")), json.load(open("heard"))
vts = json.load(open("vts.json"))
assert "wrong" not in vts, vts
full, heard = heard["full"] | {"vts": 0}, heard["faces"] | {"vts": vts["injected"]}
wrong = []
print(f"{where}, {seconds:.0f} s: {facts['samples']} samples, {facts['samples'] / seconds:.0f} a second")
for one in facts["outputs"]:
    name = one["output"].split(":")[0].split(".")[-1]
    lost = one["sent"] - heard[name]
    print(f"{name:13} {one['sent']:8} faces sent, {lost} not heard, {one['replaced']} replaced by newer ones; "
          f"sample to sent p50 {one['p50_ms']:.2f} ms, p99 {one['p99_ms']:.2f} ms")
    # What was sent after it was asked is heard, too; while VTube Studio is logged in to, nothing is injected.
    if full[name] > 0:
        print(f"SKIPPED: {name}: the listener was too slow for {full[name]} datagrams")
    elif one["sent"] == 0 or lost > (200 if name == "vts" else 0):
        wrong.append(f"{name}: {one['sent']} sent, {heard[name]} heard")
memory = [float(line) for line in open("memory")]
print("memory by tenths, MB: " + " ".join(f"{mb:.1f}" for mb in memory))
grown = memory[-1] - memory[2 * len(memory) // 3]
if seconds >= judged_from and grown > grown_most:
    wrong.append(f"memory grew by {grown:.1f} MB in the last third")
first = dict(line.split() for line in open("threads.first"))
last = dict(line.split() for line in open("threads.last"))
shares = sorted(((float(s) - float(first.get(t, 0))) / max(span, 1), t) for t, s in last.items())[::-1]
print("threads, of a processor: " + " ".join(f"{100 * share:.1f} %" for share, _ in shares))
if where == "perform" and shares and shares[0][0] > spinning:
    wrong.append(f"a thread takes {shares[0][0]:.2f} of a processor")
for line in wrong:
    print("FAILED:", line)
sys.exit(bool(wrong))
PYTHON
finish
