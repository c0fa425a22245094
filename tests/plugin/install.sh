#!/usr/bin/env bash
# What `cmake --install` makes can be moved, and is enough: outside the sources, with nothing but the
# installation, the template builds in three standards and performs a face.
source "$(dirname "$0")/lib.sh"
cmake --install "$BUILD_DIR" --prefix "$scratch/first" >"$scratch/log" 2>&1 || {
    fail "cmake --install"
    cat "$scratch/log"
    finish
}
"$scratch/first/bin/marotte" perform --face moai --input log:demo,end=1 --map one_hand --record "$scratch/show.marotte" \
    >"$scratch/log" 2>&1 || fail "record with the first installation: $(cat "$scratch/log")"
face=$scratch/first/share/marotte/rigs/moai/moai.rig.json
echo "{\"looks\": {}, \"last\": {\"face\": \"$face\"}}" >"$scratch/settings.json"
prefix="$scratch/moved to"
mv "$scratch/first" "$prefix" && mkdir "$scratch/work" && cd "$scratch/work" || exit 1

# An environment that knows of nothing else.
packages=$(dirname "$(find "$prefix" -name marotte.pc)")
alone=(env -i "PATH=$prefix/bin:/usr/bin:/bin" "HOME=$scratch" "TMPDIR=${TMPDIR:-/tmp}"
    "ASAN_OPTIONS=${ASAN_OPTIONS:-}" "LSAN_OPTIONS=${LSAN_OPTIONS:-}"
    "TSAN_OPTIONS=${TSAN_OPTIONS:-}" "MESA_SHADER_CACHE_DIR=${XDG_CACHE_HOME:-$HOME/.cache}"
    "PKG_CONFIG_PATH=$packages")

# ---- what is there ----
for file in bin/marotte bin/marotte-meshload bin/marotte-plugincheck bin/marotte-pluginhost include/marotte/plugin.h \
    share/marotte/rigs/puppet/puppet.rig.json share/marotte/rigs/moai/moai.glb \
    share/marotte/demo_hand.csv share/marotte/demo_left_hand.csv; do
    [ -s "$prefix/$file" ] || fail "$file is not installed"
done
cmp "$SOURCE_DIR/core/include/marotte/plugin.h" "$prefix/include/marotte/plugin.h" || fail "another header"
grep -rlF -e "$SOURCE_DIR" -e "$BUILD_DIR" -e "$scratch/first" "$prefix" && fail "these name a folder of the build"
find "$prefix" -type f -exec sh -c 'readelf -d "$1" 2>/dev/null | grep -E "R(UN)?PATH" | grep -v "\[\$ORIGIN" && echo "$1"' sh {} \; |
    grep . && fail "these look for libraries in a folder of the build"
find "$prefix/bin" "$prefix"/lib* -type f ! -name '*.cmake' ! -name '*.pc' -print0 |
    xargs -0 grep -aoE '\b(core|plugins|rigs|ui|tests)/[a-z_/]*[a-zA-Z_]+\.(md|rules|sh)\b' |
    grep . && fail "these messages name files of the sources"
"${alone[@]}" marotte plugin list --params >"$scratch/list" || fail "plugin list"
for plugin in log anchored unanchored one_hand cyberglove pedal osc camera openxr midi gamepad phone; do
    grep -q "^    from $prefix/lib.*/marotte/plugins/$plugin.so$" "$scratch/list" || fail "$plugin is not found"
done
grep '^    from ' "$scratch/list" | grep -vF "    from $prefix/lib" && fail "these plugins are from elsewhere"
! grep '^not used' "$scratch/list" || fail "plugins are refused"

# ---- a rig by name, unless there is such a file; what there is not is said ----
"${alone[@]}" marotte perform --verbose --face moai --input log:demo_hand.csv,end=1 --map one_hand \
    >"$scratch/facts" 2>/dev/null || fail "--face moai"
grep -qx "face  *$prefix/share/marotte/rigs/moai/moai.rig.json" "$scratch/facts" || fail "another moai"
refused 1 "nobody" "${alone[@]}" marotte perform --face nobody --input log:x.csv --map one_hand
echo nonsense >puppet
refused 1 "puppet" "${alone[@]}" marotte perform --face puppet --input log:x.csv --map one_hand
rm puppet

# ---- shows and settings of an installation that lay elsewhere ----
"${alone[@]}" marotte take export "$scratch/show.marotte" last --export "$scratch/moved.pc2" >"$scratch/log" 2>&1 ||
    fail "a show of the first installation: $(cat "$scratch/log")"
"${alone[@]}" marotte stage --hidden --seconds 0.1 --size 320x240 --settings "$scratch/settings.json" --json "$scratch/show2.marotte" \
    >"$scratch/facts" 2>"$scratch/log" || fail "settings of the first installation: $(cat "$scratch/log")"
grep -qF "$prefix/share/marotte/rigs/moai/moai.rig.json" "$scratch/settings.json" ||
    fail "the face of the settings is forgotten: $(cat "$scratch/settings.json" "$scratch/facts")"

# ---- the package: CMake in two standards, pkg-config, C++ ----
"${alone[@]}" marotte plugin new wave --mapping >"$scratch/said" || fail "plugin new"
grep -q "DCMAKE_PREFIX_PATH='$prefix'" "$scratch/said" || fail "the prefix is not said: $(cat "$scratch/said")"
cd wave || exit 1
for standard in 11 17; do
    "${alone[@]}" cmake -B build$standard -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_STANDARD=$standard \
        -DCMAKE_C_FLAGS="-Werror" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$scratch/log" 2>&1
    "${alone[@]}" cmake --build build$standard >>"$scratch/log" 2>&1 || {
        fail "C$standard"
        cat "$scratch/log"
    }
    grep -q "std=c$standard" build$standard/compile_commands.json || fail "not C$standard"
    grep -qF -e "$SOURCE_DIR" -e "$BUILD_DIR" build$standard/compile_commands.json && fail "C$standard uses the sources"
done
"${alone[@]}" cmake -B build_include -DMAROTTE_INCLUDE="$prefix/include" >"$scratch/log" 2>&1
"${alone[@]}" cmake --build build_include >>"$scratch/log" 2>&1 || fail "MAROTTE_INCLUDE"
eval "flags=($("${alone[@]}" pkg-config --cflags marotte))"
mkdir buildcpp
"${alone[@]}" c++ -x c++ -std=c++17 "${strict[@]::4}" -O2 -shared -fPIC -fvisibility=hidden \
    "${flags[@]}" wave.c -o buildcpp/wave.so || fail "C++17 by pkg-config"
eval "plugins=$("${alone[@]}" pkg-config --variable=plugindir marotte)" # it quotes blanks
[ -s "$plugins/log.so" ] || fail "no plugins in plugindir, $plugins"
echo 'cmake_minimum_required(VERSION 3.16)
project(newer LANGUAGES NONE)
find_package(marotte 99 REQUIRED)' >"$scratch/CMakeLists.txt"
"${alone[@]}" cmake -S "$scratch" -B "$scratch/newer" -DCMAKE_PREFIX_PATH="$prefix" >"$scratch/log" 2>&1 &&
    fail "version 99 was found"

# ---- each performs: vertices move, in the same way ----
for build in build11 build17 build_include buildcpp; do
    symbols=$(nm -D --defined-only $build/wave.so | awk '{ print $3 }')
    [ "$symbols" = marotte_plugins ] || fail "$build: exports $symbols"
    "${alone[@]}" marotte perform --verbose --face puppet --input log:take.csv --map $build/wave.so --export $build.pc2 \
        >"$scratch/facts" || fail "$build does not perform"
    moved 5 "$scratch/facts"
    cmp build11.pc2 $build.pc2 || fail "$build: other bits than C11"
    case $build in build17 | build_include) continue ;; esac # the same source by the same compiler
    "${alone[@]}" marotte plugin check $build/wave.so >"$scratch/log" 2>&1 || {
        fail "$build: plugin check"
        cat "$scratch/log"
    }
done
# Frames differ in the file itself, not only in what the program says of them.
frame_bytes=$(($(od -An -t u4 -j 16 -N 4 build11.pc2) * 12))
head -c $((32 + frame_bytes)) build11.pc2 | tail -c $frame_bytes >rest
head -c $((32 + 76 * frame_bytes)) build11.pc2 | tail -c $frame_bytes >fist
cmp -s rest fist && fail "the fist's frame is the rest frame"

# ---- an installed program does not look where it was built ----
mv "$prefix/bin/marotte-pluginhost" "$scratch/away"
refused 1 "marotte-pluginhost is not beside the program" "${alone[@]}" marotte perform --face puppet \
    --input log:take.csv --map build11/wave.so
mv "$scratch/away" "$prefix/bin/marotte-pluginhost"

# ---- the installed guides lead nowhere else ----
guides=0
while read -r guide; do
    guides=$((guides + 1))
    while read -r target; do
        [ -e "$(dirname "$guide")/${target%%#*}" ] || fail "${guide#"$prefix/"} links to $target, which is not installed"
    done < <(grep -oE '\]\([^)#:]+(#[^)]*)?\)' "$guide" | sed 's/](\(.*\))/\1/')
done < <(find "$prefix" -name '*.md')
[ $guides -ge 8 ] || fail "only $guides guides are installed"

# ---- what the READMEs of both kinds say, command by command ----
cd "$scratch/work" || exit 1
ln -s "$prefix" "$scratch/plain" # a shell takes $(pkg-config ...) apart at blanks
alone+=("PKG_CONFIG_PATH=${packages/"$prefix"/"$scratch/plain"}")
for kind in mapping input; do
    "${alone[@]}" marotte plugin new tried_$kind --$kind >/dev/null || fail "plugin new --$kind"
    mkdir "$scratch/$kind"
    awk -v OUT="$scratch/$kind" -f "$SOURCE_DIR/tests/plugin/guide.awk" tried_$kind/README.md
    { echo "set -e"; cat "$scratch/$kind"/*.sh; } >"$scratch/$kind.sh"
    command -v gdb >/dev/null || sed -i '/^gdb/,/[^\\]$/d' "$scratch/$kind.sh"
    (cd tried_$kind && "${alone[@]}" bash "$scratch/$kind.sh") >"$scratch/log" 2>&1 || {
        fail "the README of the $kind"
        cat "$scratch/$kind.sh" "$scratch/log"
    }
    [ "$(wc -l <"$scratch/$kind.sh")" -gt 8 ] || fail "the README of the $kind has few commands"
done
finish
