#!/usr/bin/env bash
# A downloaded head with 69 shapes of its own: drafted, performed with them and without, recorded,
# and exported from the take with the same bits.
# shellcheck source=tests/e2e/lib.sh
. "$SOURCE_DIR/tests/e2e/lib.sh"
head=$shared/data/heads/rpm_arkit.glb
if [ ! -f "$head" ]; then
    echo "SKIPPED: no $head (set MAROTTE_SHARED)"
    exit 77
fi
cp "$head" "$scratch/head.glb"
cd "$scratch" || exit 1
"$BUILD_DIR/marotte" rig new head.glb >/dev/null 2>new.err || fail "rig new: $(tail -c 200 new.err)"
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 0,/' head.rig.json >clay.rig.json
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 2,/' head.rig.json >wrong.rig.json
sed 's/"marotte_rig": *1,/"marotte_rig": 1, "shapes": 1,/' head.rig.json >said.rig.json

perform() { # NAME RIG ARGUMENTS...: NAME.pc2, and what was said in NAME.txt
    local name=$1 rig=$2
    shift 2
    timeout 120 "$BUILD_DIR/marotte" perform --verbose --face "$rig" --input "log:$demo" --map one_hand \
        --seconds 2 --export "$name.pc2" "$@" >"$name.txt" 2>"$name.err" ||
        fail "$name: $(tail -c 200 "$name.err")"
}
perform shaped head.rig.json --record show.marotte --export shaped.glb
perform clay clay.rig.json
perform said said.rig.json
cmp -s shaped.pc2 clay.pc2 && fail "shapes change nothing"
cmp -s shaped.pc2 said.pc2 || fail "\"shapes\": 1 is not what is meant where nothing is said"
for name in shaped clay; do
    [ "$(fact folds $name.txt)" = 0 ] || fail "$name: $(fact folds $name.txt) folds"
done
timeout 120 "$BUILD_DIR/marotte" take export show.marotte 1 --export again.pc2 >/dev/null 2>again.err ||
    fail "take export: $(tail -c 200 again.err)"
cmp -s shaped.pc2 again.pc2 || fail "a take of a head with shapes has other bits than what was performed"

# A patch moves the shapes themselves, beside the hand: the take is bit for bit, and changed afterwards.
awk 'BEGIN {
    print "time_s,face.smile,face.jaw\nunit,0..1,0..1"
    for (i = 0; i < 200; i += 1) printf "%.3f,%.4f,%.4f\n", i * 0.01, 0.5 - 0.5 * cos(i * 0.03), 0.5 - 0.5 * cos(i * 0.05)
}' >face.csv
patch_of() { # weight of a whole smile
    printf '{"marotte_patch": 1, "connections": [
        {"from": {"channel": "face.smile"}, "to": {"shape": "mouthSmileLeft"}, "out": [0, %s], "mode": "add"},
        {"from": {"channel": "face.smile"}, "to": {"shape": "mouthSmile_R"}, "smooth_s": 0.1},
        {"from": {"channel": "face.jaw"}, "to": {"shape": "jawOpen"}},
        {"from": {"channel": "face.jaw"}, "to": {"shape": "no such shape"}}]}' "$1"
}
patch_of 1 >whole.json
patch_of 0.3 >less.json
perform patched head.rig.json --input log:face.csv --patch whole.json --record patched.marotte
perform less head.rig.json --input log:face.csv --patch less.json
grep -q 'the head has no shape and the rig no pose "no such shape"' patched.err || fail "what is missing is not said: $(cat patched.err)"
[ "$(grep -c 'note: patch' patched.err)" = 1 ] || fail "a shape is not found: $(cat patched.err)"
cmp -s patched.pc2 shaped.pc2 && fail "a patched shape moves nothing"
[ "$(fact folds patched.txt)" = 0 ] || fail "patched: $(fact folds patched.txt) folds"
again() { # NAME: the last take of patched.marotte is NAME.pc2
    timeout 120 "$BUILD_DIR/marotte" take export patched.marotte last --export again.pc2 >/dev/null 2>again.err ||
        fail "take export: $(tail -c 200 again.err)"
    cmp -s "$1.pc2" again.pc2 || fail "a take with patched shapes has other bits than $1"
}
again patched
# A range is performed from a state that was kept on the way, and is that part of the whole.
"$BUILD_DIR/marotte" take export patched.marotte last --in 1.4 --out 1.9 --export part.pc2 >/dev/null 2>again.err ||
    fail "take export --in: $(tail -c 200 again.err)"
frame_size=$((12 * $(od -An -t u4 -j 16 -N 4 part.pc2)))
cmp -n $((10 * frame_size)) -i "32:$((32 + 42 * frame_size))" part.pc2 patched.pc2 || fail "a range with patched shapes has other bits"
"$BUILD_DIR/marotte" take remap patched.marotte 1 --patch less.json >/dev/null 2>again.err || fail "remap: $(cat again.err)"
again less

# What the face says in ARKit's names, performed by the patch of a phone, is that face: said again, and turned as it was.
perform spoken head.rig.json --export spoken.livelink.csv --input log:face.csv --patch whole.json
awk -F, 'NR == 1 { printf "time_s"; for (i = 3; i <= NF; ++i) printf ",%s", tolower(substr($i, 1, 1)) substr($i, 2)
        printf "\nunit"; for (i = 3; i <= NF; ++i) printf ",%s", i < 55 ? "0..1" : "-3.2..3.2"; print ""; next }
    { printf "%.5f", (NR - 2) / 30; for (i = 3; i <= NF; ++i) printf ",%s", $i; print "" }' spoken.livelink.csv >heard.csv
sed 's/"input": "phone", //' "$SOURCE_DIR/ui/patches/phone_face.json" >heard.json
timeout 120 "$BUILD_DIR/marotte" perform --verbose --face head.rig.json --input log:heard.csv --map one_hand --patch heard.json \
    --export heard.livelink.csv >/dev/null 2>heard.err || fail "phone_face: $(tail -c 200 heard.err)"
paste -d, spoken.livelink.csv heard.livelink.csv | awk -F, 'NR == 1 { half = NF / 2; split($0, name, ","); next }
    NR > 15 { for (i = 3; i <= half; ++i) { d = $i - $(half + i); sum[i] += d < 0 ? -d : d }; ++n }
    END { for (i in sum) if (sum[i] / n > 0.06) { print name[i], sum[i] / n; bad = 1 }; exit bad || n < 40 }' >apart.txt ||
    fail "a face from a phone is another: $(cat apart.txt)"
# The same head as a VRM whose shapes are called otherwise: its table of expressions says what they are.
if command -v python3 >/dev/null; then
    python3 - <<'PYTHON'
import json, struct
glb = open("head.glb", "rb").read()
size = struct.unpack("<I", glb[12:16])[0]
document, rest = json.loads(glb[20:20 + size]), glb[20 + size:]
node_of, binds = {n["mesh"]: i for i, n in enumerate(document["nodes"]) if "mesh" in n}, {}
for index, mesh in enumerate(document["meshes"]):
    names = mesh.get("extras", {}).get("targetNames", [])
    for i, name in enumerate(names):
        binds.setdefault(name, []).append({"node": node_of[index], "index": i, "weight": 1})
    if names:
        mesh["extras"]["targetNames"] = ["Shape%d" % i for i in range(len(names))]
smile = [dict(b, weight=0.9) for name in ("mouthSmileLeft", "mouthSmileRight") for b in binds[name]]
document.setdefault("extensions", {})["VRMC_vrm"] = {"specVersion": "1.0", "expressions": {
    "preset": {"happy": {"morphTargetBinds": smile}},
    "custom": {name: {"morphTargetBinds": b} for name, b in binds.items()}}}
text = json.dumps(document).encode()
text += b" " * (-len(text) % 4)
out = glb[:12] + struct.pack("<I", len(text)) + b"JSON" + text + rest
open("words.vrm", "wb").write(out[:8] + struct.pack("<I", len(out)) + out[12:])
PYTHON
    "$BUILD_DIR/marotte" rig new words.vrm >/dev/null 2>new.err || fail "rig new of a VRM: $(tail -c 200 new.err)"
    perform words words.rig.json
    cmp -s words.pc2 shaped.pc2 || fail "a head whose shapes are known by its expressions is another"
    printf '{"marotte_patch": 1, "connections": [{"from": {"channel": "face.smile"}, "to": {"shape": "happy"}}]}' >happy.json
    perform happy words.rig.json --input log:face.csv --patch happy.json --export happy.livelink.csv
    grep -q 'note: patch' happy.err && fail "an expression is not found: $(cat happy.err)"
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
        { if ($at["MouthSmileLeft"] > left) left = $at["MouthSmileLeft"]; if ($at["MouthSmileRight"] > right) right = $at["MouthSmileRight"] }
        END { print left, right; exit !(left > 0.8 && left < 1 && right > 0.8 && right < 1) }' happy.livelink.csv >happy.said ||
        fail "nine tenths of a smile are said as $(cat happy.said)"
else
    echo "SKIPPED: the head as a VRM (python3 is not installed)"
fi
refused 1 "shapes" "$BUILD_DIR/marotte" perform --face wrong.rig.json --input "log:$demo" --map one_hand --seconds 1
finish
