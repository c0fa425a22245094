#!/usr/bin/env bash
# Every command that the README and the guides of the site show works as shown, from the top folder, but for blocks that are marked
# "not run". Except in ./test --long, pictures and videos are smaller and recordings shorter. The stage runs for a second without a
# window. Other tests run the guides of plugins and of contributors.
source "$(dirname "$0")/lib.sh"
cd "$SOURCE_DIR" || exit 1
mkdir "$scratch/bin"
ln -s "$MAROTTE" "$scratch/bin/marotte"
export PATH=$scratch/bin:$PATH
count=0
if [ -z "${MAROTTE_TEST_LONG:-}" ]; then # ./run itself, with the first seconds of its recordings
    sed -E 's#^here=.*#here=$SOURCE_DIR#; s#(demo_hand|demo_left_hand)\.csv#&,end=2#g; s#log:demo( |$)#log:demo,end=2\1#g; s#\.png"#& --size 640x320#; s#640x360#160x90#' \
        run >"$scratch/run"
    [ "$(grep -c 'end=2' "$scratch/run")" -eq 3 ] || fail "run performs other recordings"
fi
rm -f out/head.rig.json # of a run before: rig new does not overwrite it
commands() { # GUIDE: its commands, a line each
    awk -v OUT="$scratch/blocks" -f tests/plugin/guide.awk "$1"
    cat "$scratch"/blocks/*.none.sh 2>/dev/null
}
for guide in $(sed -nE '/^#/! s/^([^ ]+\.md).*/\1/p' ui/guide/contents.txt); do
    case $guide in plugins/README.md | CONTRIBUTING.md) continue ;; esac
    rm -rf "$scratch/blocks"
    mkdir "$scratch/blocks"
    while read -r line; do
        case $line in
        "" | "#"* | ./test*) continue ;;
        "marotte bench --quick" | "marotte paper --quick") continue ;; # bench/gate and e2e/paper run these
        "marotte stage"*) line="$line --hidden --seconds 1" ;;
        blender*) command -v blender >/dev/null || { echo "SKIPPED: Blender is not installed: $line"; continue; } ;;
        esac
        if [ -z "${MAROTTE_TEST_LONG:-}" ]; then
            line=$(sed -E 's/--size [0-9]+x[0-9]+/--size 160x90/; /--size/! s/^marotte .*\.png.*/& --size 640x320/
                s/log:demo( |$)/log:demo,end=5.2\1/; s/rig check .*puppet.*/rig check moai/; s/--poses/& --only joy,jawOpen/
                s/--frames 1-50/--frames 1-10/; s/--frames 51-100/--frames 11-20/; s#^\./run$#bash "$scratch/run"#' <<<"$line")
        fi
        count=$((count + 1))
        echo "\$ $line"
        scratch=$scratch bash -c "$line" >"$scratch/log" 2>&1 || { fail "$line"; tail -n 5 "$scratch/log"; }
    done < <(commands "$guide")
done
[ $count -ge 20 ] || fail "only $count commands were found in the guides"
finish
