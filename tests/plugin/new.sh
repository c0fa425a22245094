#!/usr/bin/env bash
# `marotte plugin new`: what it writes compiles and performs as written, by the very commands that it
# prints; what it cannot do it refuses, and leaves nothing behind.
source "$(dirname "$0")/lib.sh"
mkdir "$scratch/some where" && cd "$scratch/some where" || exit 1

# ---- both kinds, as a person would ----
for kind in mapping input; do
    "$MAROTTE" plugin new my_$kind --$kind >"$scratch/said" || fail "plugin new --$kind"
    found=$(cd my_$kind && echo *)
    [ "$found" = "CMakeLists.txt README.md my_$kind.c take.csv" ] || fail "$kind: wrote $found"
    grep -rn template_name my_$kind && fail "$kind: the placeholder is left"
    compiles my_$kind/my_$kind.c -I "$SOURCE_DIR/core/include"

    mapfile -t next < <(grep '^  ' "$scratch/said")
    [ ${#next[@]} -eq 3 ] || fail "$kind: ${#next[@]} commands instead of 3"
    [[ ${next[1]} = *"plugin check build/my_$kind.so" ]] || fail "$kind: the second command is ${next[1]}"
    # One picture is enough: the guide's test makes the input's.
    [ $kind = mapping ] || next[2]=${next[2]/face.png/face.csv}
    printf '%s\n' "set -e" "${next[@]}" >"$scratch/next.sh"
    bash "$scratch/next.sh" >"$scratch/facts" 2>&1 || {
        fail "$kind: what it says to do next does not work"
        cat "$scratch/next.sh" "$scratch/facts"
    }
    moved 5 "$scratch/facts"
    [ -s my_$kind/face.png ] || [ -s my_$kind/face.csv ] || fail "$kind: nothing is exported"
done

# ---- the mapping moves a face with a rig, one without, and nothing where there is no hand ----
wave=my_mapping/build/my_mapping.so
for face in "$puppet" "$moai"; do
    "$MAROTTE" perform --verbose --face "$face" --input log:my_mapping/take.csv --map $wave \
        --export "$scratch/moved.csv" >"$scratch/facts" || fail "$face"
    moved 5 "$scratch/facts"
    [ "$(fact folds "$scratch/facts")" = 0 ] || fail "$face folds"
done
"$MAROTTE" perform --verbose --face puppet --input log:my_mapping/take.csv --map $wave,push=0 >"$scratch/less"
"$MAROTTE" perform --verbose --face puppet --input log:my_mapping/take.csv --map $wave,push=6 >"$scratch/more"
awk -v a="$(fact "range of motion" "$scratch/less")" -v b="$(fact "range of motion" "$scratch/more")" \
    'BEGIN { exit !(a + 1 < b) }' || fail "push=0 and push=6 move the same" # near a fold less is given

# ---- one that takes a root: the template links what it needs; built without, it is loaded all the same ----
cp -r my_mapping rooted && rm -r rooted/build
sed -i 's/#include <stdlib.h>/#include <math.h>\n&/; s/float mm = self->bend \*/float mm = sqrtf(self->bend * self->bend) */' rooted/my_mapping.c
grep -q 'sqrtf' rooted/my_mapping.c || fail "the template has no such line any more"
prefix=$(grep -o -- '-D[^ ]*' <<<"${next[0]}" | head -n 1)
(cd rooted && eval "cmake -B build $prefix && cmake --build build") >"$scratch/facts" 2>&1 || { fail "rooted"; cat "$scratch/facts"; }
nm -D rooted/build/my_mapping.so | grep -q ' U sqrtf' || fail "sqrtf is no call: this tests nothing"
readelf -d rooted/build/my_mapping.so | grep -q 'NEEDED.*libm' || fail "the template links no libm"
cc -O2 -shared -fPIC -ffp-contract=off -I "$SOURCE_DIR/core/include" rooted/my_mapping.c -o rooted/bare.so || fail "cc"
"$MAROTTE" plugin check rooted/build/my_mapping.so >"$scratch/facts" 2>&1 || { fail "rooted"; cat "$scratch/facts"; }
for library in rooted/build/my_mapping.so rooted/bare.so; do # bare.so is checked below, by its name
    "$MAROTTE" perform --verbose --face puppet --input log:my_mapping/take.csv --map $library --isolate on \
        >"$scratch/facts" 2>&1 || { fail "$library apart"; cat "$scratch/facts"; }
    moved 5 "$scratch/facts"
done

# ---- a library that lies here is named without a path too ----
(cd rooted && "$MAROTTE" plugin check bare.so) >"$scratch/facts" 2>&1 || { fail "check bare.so"; cat "$scratch/facts"; }
(cd rooted && "$MAROTTE" perform --verbose --face puppet --input log:take.csv --map bare.so,push=4) >"$scratch/facts" 2>&1 ||
    { fail "--map bare.so"; cat "$scratch/facts"; }
moved 5 "$scratch/facts"

# ---- the input gives what its take holds, to the bit, however fast it runs ----
"$MAROTTE" perform --face puppet --input my_input/build/my_input.so,seconds=1.99 --map one_hand \
    --export "$scratch/now.csv" >/dev/null 2>&1 || fail "the input"
"$MAROTTE" perform --face puppet --input log:my_input/take.csv --map one_hand \
    --export "$scratch/then.csv" >/dev/null 2>&1 || fail "the input's take"
cmp "$scratch/now.csv" "$scratch/then.csv" || fail "plugins/template/input.csv is not what input.c gives"
"$MAROTTE" perform --face puppet --input my_input/build/my_input.so,seconds=0.2,hand=left \
    --map anchored --realtime --json >"$scratch/live" 2>&1 || fail "the input in real time"
grep -q '"samples": 21' "$scratch/live" || fail "0.2 s at 100 Hz: $(grep samples "$scratch/live")"
refused 1 "takes no address" "$MAROTTE" perform --face puppet --input my_input/build/my_input.so:x --map one_hand

# ---- the output says the face that is performed, to whoever listens ----
"$MAROTTE" plugin new my_output --output >"$scratch/said" || fail "plugin new --output"
compiles my_output/my_output.c -I "$SOURCE_DIR/core/include"
mapfile -t next < <(grep '^  ' "$scratch/said")
[[ ${#next[@]} -eq 3 && ${next[2]} = *"--output build/my_output.so:127.0.0.1:9200" ]] || fail "output: ${next[*]}"
if command -v python3 >/dev/null; then
    python3 - "$scratch/port" >"$scratch/heard" <<'PYTHON' &
import os, socket, sys
at = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
at.bind(("127.0.0.1", 0))
with open(sys.argv[1] + ".new", "w") as file:
    file.write(str(at.getsockname()[1]))
os.rename(sys.argv[1] + ".new", sys.argv[1])
while True: # until it is ended: an output tells when its listener has gone
    print(at.recv(2000).decode(), flush=True)
PYTHON
    listener=$!
    for _ in $(seq 600); do [ -s "$scratch/port" ] || sleep 0.1; done
    printf '%s\n' "set -e" "${next[@]/%:9200/:$(cat "$scratch/port")}" >"$scratch/next.sh"
    bash "$scratch/next.sh" >"$scratch/facts" 2>&1 || { fail "output: what it says to do next does not work"; cat "$scratch/facts"; }
    grep -q 'my_output.*: sent, [0-9]' "$scratch/facts" || fail "output: $(grep my_output "$scratch/facts")"
    least=100
    [ -z "${SANITIZED:-}" ] || least=20 # the newest face is sent, as fast as there is one
    for _ in $(seq 600); do [ "$(grep -c '^time' "$scratch/heard")" -ge $least ] || sleep 0.1; done
    kill $listener
    awk -v least=$least '$1 == "time" { ++faces } $1 == "JawOpen" && $2 > most { most = $2 }
        END { exit !(faces >= least && most > 0.02) }' "$scratch/heard" ||
        fail "output: $(tail -n 5 "$scratch/heard")"
else
    echo "SKIPPED: python3 is not installed"
fi

# ---- names that a build system or a shell could trip over ----
for name in test all plugin a x0123456789012345678901_; do
    "$MAROTTE" plugin new $name --mapping --dir "$scratch" >"$scratch/said" || fail "$name"
done
(cd "$scratch/test" && eval "$(sed -n 's/.*&& \(cmake -B .*\)/\1/p' "$scratch/said")") >/dev/null ||
    fail "a plugin called test does not build"
[ -s "$scratch/test/build/test.so" ] || fail "no test.so"

# ---- refusals ----
echo mine >my_mapping/my_mapping.c
before=$(ls -A)
refused 1 "my_mapping exists already" "$MAROTTE" plugin new my_mapping --mapping
[ "$(cat my_mapping/my_mapping.c)" = mine ] || fail "an existing folder was changed"
touch a_file && refused 1 "a_file exists already" "$MAROTTE" plugin new a_file --input && rm a_file
touch a_file && refused 1 "a_file: cannot create this folder" "$MAROTTE" plugin new fresh --mapping --dir ./a_file && rm a_file
refused 2 "choose --mapping, --input or --output" "$MAROTTE" plugin new fresh
refused 2 "only one of --mapping" "$MAROTTE" plugin new fresh --mapping --input
refused 2 "NAME is missing" "$MAROTTE" plugin new --mapping
refused 2 "--dir needs a value" "$MAROTTE" plugin new fresh --mapping --dir
refused 2 "unexpected argument \"other\"" "$MAROTTE" plugin new fresh other --mapping
refused 2 "there is no option \"--fast\"" "$MAROTTE" plugin new fresh --mapping --fast
for name in "" Wave wave-2 2wave _wave "wa ve" ../wave wave/x . "wäve" "$(printf 'wa\nve')" \
    a1234567890123456789012345; do
    refused 2 "cannot be a plugin's name" "$MAROTTE" plugin new "$name" --mapping
done
for name in int switch class restrict co_await; do
    [ $name = co_await ] && continue # a word of C++20 alone
    refused 2 "is a word of C or C++" "$MAROTTE" plugin new $name --mapping
done
long=$(printf 'd%.0s' $(seq 4090))
refused 1 "the path of the folder is too long" "$MAROTTE" plugin new fresh --mapping --dir "$long"

# A disk that is full: nothing half is left behind.
(ulimit -f 1 && "$MAROTTE" plugin new fresh --mapping) >"$scratch/stdout" 2>"$scratch/stderr" &&
    fail "wrote more than the disk holds"
[ "$(wc -l <"$scratch/stderr")" -eq 1 ] || fail "a full disk: $(cat "$scratch/stderr")"
if [ "$(id -u)" -ne 0 ]; then
    mkdir "$scratch/closed" && chmod 555 "$scratch/closed"
    refused 1 "cannot create the folder" "$MAROTTE" plugin new fresh --mapping --dir "$scratch/closed"
fi
[ "$(ls -A)" = "$before" ] || fail "left behind: $(ls -A)"
finish
