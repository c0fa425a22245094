#!/usr/bin/env bash
# Makes build/portable/marotte-VERSION-x86_64.tar.zst: marotte in a folder that runs from any place, on each Linux whose C library is
# 2.31 or later. ./run portable runs this. clang of Debian 12 builds against a root folder of Debian 11 (sysroot). What Debian 11 does
# not have, or has too old, comes from Debian 12: headers and a static library, and OpenMesh, built from its source package.
# packaging/README.md tells what is inside and what is expected of the system.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$here/.ci/setup.sh"

work=${1:-$here/build/portable} # also the folder of the result
sysroot=$work/sysroot libraries=lib/marotte/libraries triple=x86_64-linux-gnu
version=$(sed -n 's/^project(marotte VERSION \([0-9.]*\).*/\1/p' "$here/CMakeLists.txt")
name=marotte-$version-x86_64
tree=$work/marotte # NAME in the archive

# In the sysroot. Not in it, so not in the archive: PipeWire, whose library belongs to its daemon; OpenXR, whose runtimes load their own
# libraries; PocketSphinx, for its 30 MB.
development=(libc6-dev libstdc++-10-dev libjansson-dev libsuitesparse-dev libpng-dev libdraco-dev libmeshoptimizer-dev libjpeg-dev
    libwebp-dev libepoxy-dev libegl-dev libfreetype-dev libusb-1.0-0-dev liblo-dev libsqlite3-dev zlib1g-dev nettle-dev libsndfile1-dev
    libsamplerate0-dev portaudio19-dev libglfw3-dev libasound2-dev libsystemd-dev)
newer=(libimgui-dev libstb-dev libtinygltf-dev nlohmann-json3-dev fonts-inter fonts-dejavu-core) # of Debian 12
fonts=(opentype/inter/Inter-{Regular,Medium,SemiBold}.otf truetype/dejavu/DejaVuSans.ttf)
# Of the system: its C and C++ libraries; what talks to its kernel, display and sound; zlib, which graphics drivers load, too.
expected='^(ld-linux-x86-64|lib(c|m|dl|rt|pthread|util|resolv|stdc\+\+|gcc_s|asound|X[A-Za-z0-9]*|xcb[-a-z]*|wayland-[a-z]+|GL|GLX|EGL|OpenGL|GLdispatch|udev|z))\.so'

make_sysroot() {
    local suite uri
    rm -rf "$sysroot" "$work/newer"
    mkdir -p "$work/newer"
    # shellcheck disable=SC2016
    read -r uri suite < <(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 'Component: main' 'Release: bookworm')
    setup_step "unpacking Debian 11" 0 mmdebstrap --variant=extract --include="$(IFS=,; echo "${development[*]}")" \
        bullseye "$sysroot" "deb $uri bullseye main"
    (cd "$work/newer" && setup_step "downloading of Debian 12" 0 apt-get -q download "${newer[@]}")
    for package in "$work/newer"/*.deb; do dpkg-deb -x "$package" "$sysroot"; done
    rm "$sysroot/usr/lib/$triple/libstb.so" # the static library is linked: Dear ImGui needs it as new as itself
    # Links to other places of the root become links within the sysroot.
    find "$sysroot" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
        ln -snf "$(realpath -ms --relative-to="$(dirname "$link")" "$sysroot$target")" "$link"
    done
    make_openmesh "$uri" "$suite"
}

make_openmesh() { # URI SUITE
    local source=$work/openmesh apt library
    rm -rf "$source"
    mkdir -p "$source/apt/lists/partial" "$source/apt/cache/archives/partial"
    echo "deb-src $1 $2 main" >"$source/apt/list"
    apt=(apt-get -q -o "Dir::Etc::SourceList=$source/apt/list" -o Dir::Etc::SourceParts=- -o "Dir::State::Lists=$source/apt/lists"
        -o "Dir::Cache=$source/apt/cache" -o APT::Sandbox::User=root)
    setup_step "updating the list of sources" 0 "${apt[@]}" update
    (cd "$source" && setup_step "downloading OpenMesh" 0 "${apt[@]}" source --only-source openmesh)
    setup_step "configuring OpenMesh" 0 cmake -G Ninja -S "$source"/openmesh-*/ -B "$source/build" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_TOOLCHAIN_FILE="$here/packaging/portable/toolchain.cmake" -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_APPS=OFF \
        -DCMAKE_CXX_FLAGS="-ffile-prefix-map=$source=." -DCMAKE_SKIP_RPATH=ON
    setup_step "building OpenMesh" 0 cmake --build "$source/build"
    setup_step "installing OpenMesh" 0 env DESTDIR="$sysroot" cmake --install "$source/build" --strip
    for library in libopenmeshcore9.0 libopenmeshtools9.0; do
        mkdir -p "$sysroot/usr/share/doc/$library"
        cp "$source"/openmesh-*/debian/copyright "$sysroot/usr/share/doc/$library/"
    done
}

bundle_fonts() {
    local font package
    for font in "${fonts[@]}"; do
        install -D -m 644 "$sysroot/usr/share/fonts/$font" "$tree/share/marotte/fonts/${font##*/}"
    done
    for package in fonts-inter fonts-dejavu-core; do
        install -D -m 644 "$sysroot/usr/share/doc/$package/copyright" "$tree/share/doc/marotte/libraries/$package.copyright"
    done
}

needed() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }

# The licence of a library: libpng16.so.16 is of the package libpng16-16 or of one whose name goes on, unless it shares a package.
copy_licence() {
    local package
    package=$(sed -E 's/([0-9])\.so\./\1-/; s/\.so\.?//; s/.*/\L&/; s/^libbrotli(dec|common)/libbrotli/; s/^libdb-/libdb/' <<<"$1")
    for package in "$sysroot/usr/share/doc/$package" "$sysroot/usr/share/doc/$package"*; do
        if [ -e "$package/copyright" ]; then
            cp -L "$package/copyright" "$tree/share/doc/marotte/libraries/${package##*/}.copyright"
            return
        fi
    done
    echo "there is no licence of $1" >&2
    exit 1
}

# Copies what the programs and plugins load, and what that loads, unless the system has it; with the licence of each.
bundle() {
    local open=("$tree"/bin/* "$tree"/lib/marotte/plugins/*.so) file library found package
    mkdir -p "$tree/$libraries" "$tree/share/doc/marotte/libraries"
    while [ ${#open[@]} -gt 0 ]; do
        file=${open[0]} open=("${open[@]:1}")
        for library in $(needed "$file"); do
            [[ $library =~ $expected || -e $tree/$libraries/$library ]] && continue
            found=$(find "$sysroot"/lib/$triple "$sysroot"/usr/lib/$triple "$sysroot"/usr/lib -name "$library" 2>/dev/null | head -n 1)
            [ -n "$found" ] || { echo "no library $library, which $file loads" >&2; exit 1; }
            found=$(readlink -f "$found")
            install -m 644 "$found" "$tree/$libraries/$library"
            open+=("$tree/$libraries/$library")
            copy_licence "$library"
        done
    done
}

# What must hold, or there is no archive.
check() {
    local file newest path status=0
    while read -r file; do
        newest=$(objdump -T "$file" 2>/dev/null | grep -oE 'GLIBC_[0-9.]+' | sort -uV | tail -n 1)
        [ "$(printf '%s\n' GLIBC_2.31 "$newest" | sort -V | tail -n 1)" = GLIBC_2.31 ] ||
            { echo "${file#"$tree/"} needs $newest"; status=1; }
    done < <(find "$tree" -type f \( -path '*/bin/*' -o -name '*.so*' \))
    for path in "$here" "$work"; do
        ! grep -rlF "$path" "$tree" || { echo "these name $path"; status=1; }
    done
    return $status
}

setup_install mmdebstrap clang dpkg-dev zstd "${setup_required_packages[@]}"
export MAROTTE_SYSROOT=$sysroot
[ -f "$sysroot/complete" ] || { make_sysroot; touch "$sysroot/complete"; }
setup_step configuring 0 cmake -G Ninja -S "$here" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_LIBDIR=lib \
    -DCMAKE_TOOLCHAIN_FILE="$here/packaging/portable/toolchain.cmake" \
    -DCMAKE_EXE_LINKER_FLAGS="-Wl,--disable-new-dtags '-Wl,-rpath,\$ORIGIN/../$libraries'" # DT_RPATH: for plugins, too
setup_step building 0 cmake --build "$work/build"
rm -rf "$tree"
setup_step installing 0 cmake --install "$work/build" --prefix "$tree" --strip
bundle
bundle_fonts
ln -s bin/marotte "$tree/marotte" # what a person double-clicks
check
epoch=${SOURCE_DATE_EPOCH:-$(git -C "$here" log -1 --format=%ct 2>/dev/null || echo 0)}
tar -C "$work" --transform "flags=r;s|^marotte|$name|" --sort=name --mtime="@$epoch" --owner=0 --group=0 --numeric-owner --mode=go=rX,u+w -cf - marotte |
    zstd -q -19 -f -o "$work/$name.tar.zst"
echo "wrote ${work#"$PWD/"}/$name.tar.zst: $(du -h "$work/$name.tar.zst" | cut -f1), $(du -sh "$tree" | cut -f1) unpacked"
