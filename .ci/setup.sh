# Installs the packages and builds, with one moving line on a terminal. Shared by ./run and ./test, which set $here, the top
# folder. Everything that apt-get, cmake and npm print goes to $setup_log.
# shellcheck shell=bash

setup_log=$here/build/setup.log
setup_quiet_s=10 # after so long without a step, the line names what is being worked on

setup_required_packages=(
    build-essential cmake ninja-build pkg-config
    libopenmesh-dev libtinygltf-dev nlohmann-json3-dev libjansson-dev libsuitesparse-dev libpng-dev
    libdraco-dev libmeshoptimizer-dev libjpeg-dev libwebp-dev
    libepoxy-dev libegl-dev libfreetype-dev
    libusb-1.0-0-dev liblo-dev libsqlite3-dev zlib1g-dev nettle-dev libsndfile1-dev libsamplerate0-dev portaudio19-dev
    libglfw3-dev libimgui-dev
    libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri libglx-mesa0
)
# marotte builds without these. Installed with the first set-up where apt-get has them.
setup_optional_packages=(fonts-inter libfontconfig1-dev libpocketsphinx-dev pocketsphinx-en-us libasound2-dev libopenxr-dev libpipewire-0.3-dev libsystemd-dev)
setup_test_packages=(libcmocka-dev ruby-mdl sqlite3 libumockdev-dev umockdev liblo-tools clang-format-14 nodejs
    libespeak-ng-dev espeak-ng-data xvfb xdotool openbox wmctrl x11-utils picom fonts-droid-fallback fonts-lohit-deva ffmpeg pipewire pipewire-bin dbus-daemon)
# For ./run package: debian/control names them, too.
setup_package_packages=(debhelper dpkg-dev librsvg2-bin libcmocka-dev pandoc fakeroot xz-utils)
# For ./test --long: the fuzz targets, clang-tidy, the guide of plugins in a debugger.
setup_long_packages=(pandoc clang libclang-rt-14-dev clang-tidy-14 gdb)
# For tests/cross.sh; the libraries come from .ci/sysroot.sh and .ci/windows_libraries.sh.
setup_arm64_packages=(g++-aarch64-linux-gnu qemu-user-static)
setup_windows_packages=(g++-mingw-w64-x86-64-posix libz-mingw-w64-dev wine wine64 dpkg-dev tcl m4)

# setup_missing PACKAGE...: prints those that are not installed, one a line.
setup_missing() {
    local package installed
    installed=" $(dpkg-query -W -f '${db:Status-Abbrev}${Package} ' "$@" 2>/dev/null || true)"
    for package in "$@"; do
        case $package in nodejs | npm) # may also come from elsewhere
            command -v "${package/nodejs/node}" >/dev/null && continue ;;
        esac
        [[ $installed == *" ii $package "* ]] || echo "$package"
    done
}

# setup_follow VERB TOTAL: copies standard input to the log and shows how far it is. Understands the status lines of apt-get
# and the steps of ninja. Without a terminal it prints a line every $setup_quiet_s seconds.
setup_follow() {
    local verb=$1 total=$2 count=0 at="" line="" status began=$SECONDS stepped=$SECONDS printed=$SECONDS text
    while :; do
        IFS= read -r -t 1 part && status=0 || status=$?
        line+=$part
        if [ $status -eq 0 ]; then
            printf '%s\n' "$line" >>"$setup_log"
            at=
            case $line in
            dlstatus:*) [[ $line =~ ([0-9]+)\ of\ [0-9]+ ]] && verb=downloading count=${BASH_REMATCH[1]} stepped=$SECONDS ;;
            pmstatus:*:"Unpacking "*) [ "$verb" = unpacking ] || count=0 verb=unpacking
                count=$((count + 1)) stepped=$SECONDS ;;
            pmstatus:*:"Installed "*) [ "$verb" = installing ] || count=0 verb=installing
                count=$((count + 1)) stepped=$SECONDS ;;
            pmstatus:*) at=${line##*:} ;;
            "["*/*"] "*) count=${line%%/*} count=${count#[} total=${line#*/} total=${total%%]*} stepped=$SECONDS ;;
            esac
            line=
        elif [ $status -le 128 ]; then # the end; more than 128: nothing came for a second
            break
        fi
        text="  $verb"
        [ "$total" -eq 0 ] || text+=" $count of $total"
        text+=", $(setup_time $((SECONDS - began)))"
        if [ $((SECONDS - stepped)) -ge $setup_quiet_s ]; then
            [ -n "$at" ] || at=$(setup_compiled)
            text+=${at:+": $at"}
        fi
        if [ -t 1 ]; then
            printf '\r\033[K%.78s' "$text"
        elif [ $((SECONDS - printed)) -ge $setup_quiet_s ]; then
            printf '%s\n' "$text"
            printed=$SECONDS
        fi
    done
    [ ! -t 1 ] || printf '\r\033[K'
}

# The first source file that a compiler is working on.
setup_compiled() {
    cat /proc/[0-9]*/cmdline 2>/dev/null | tr '\0' '\n' | grep -m 1 -E "^$here/.*\.(c|cpp)$" | sed "s|^$here/||" || true
}

setup_time() { # SECONDS: as 1:05
    printf '%d:%02d' $(($1 / 60)) $(($1 % 60))
}

# setup_step VERB TOTAL COMMAND...: runs it behind the moving line. Where it fails, prints the end of the log and ends.
setup_step() {
    local verb=$1 total=$2
    shift 2
    mkdir -p "${setup_log%/*}"
    printf '\n$ %s\n' "$*" >>"$setup_log"
    if ! "$@" 2>&1 </dev/null | setup_follow "$verb" "$total" >&2; then
        tail -n 30 "$setup_log" >&2
        echo "Failed while $verb. The whole output is in ${setup_log#"$PWD"/}" >&2
        exit 1
    fi
}

# setup_install PACKAGE...: installs those that are missing, and says first how many and how large they are.
setup_install() {
    local missing=() optional=() as_root=() apt plan count began=$SECONDS package
    if ! command -v dpkg-query >/dev/null; then
        [ -d "$here/build" ] || echo "This is not Debian. marotte needs these Debian packages or what they contain: $*" >&2
        return 0
    fi
    mapfile -t missing < <(setup_missing "$@")
    [ ${#missing[@]} -gt 0 ] || return 0
    mapfile -t optional < <(setup_missing "${setup_optional_packages[@]}")
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "Cannot install packages: you are not root, and sudo is not installed. Run this as root, then try again:" >&2
            echo "  apt-get install --no-install-recommends ${missing[*]} ${optional[*]}" >&2
            exit 1
        fi
        as_root=(sudo)
        sudo true # asks for the password before the moving line
    fi
    apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -o DPkg::Lock::Timeout=600 -o APT::Status-Fd=1 -q)
    setup_step "updating the list of packages" 0 "${apt[@]}" update
    for package in "${optional[@]}"; do
        if apt-cache show "$package" >/dev/null 2>&1; then missing+=("$package"); fi
    done
    plan=$("${apt[@]}" install --no-install-recommends --assume-no "${missing[@]}" 2>/dev/null || true)
    count=$(sed -nE 's/.* ([0-9]+) newly installed.*/\1/p' <<<"$plan")
    echo "Installing ${#missing[@]} Debian packages and what they need: ${count:-?} packages," \
        "$(sed -nE 's/^Need to get ([0-9.,]+ .?B).*/\1/p' <<<"$plan") to download," \
        "$(sed -nE 's/^After this operation, ([0-9.,]+ .?B).*/\1/p' <<<"$plan") on disk. Details: ${setup_log#"$PWD"/}" >&2
    setup_step installing "${count:-0}" "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
    echo "Installed in $(setup_time $((SECONDS - began)))." >&2
}

# setup_build PRESET TARGET [cmake options]: configures once, and again with options; builds.
setup_build() {
    local preset=$1 target=$2 began=$SECONDS
    shift 2
    if [ $# -gt 0 ] || [ ! -f "$here/build/$preset/build.ninja" ]; then
        setup_step configuring 0 cmake -S "$here" --preset "$preset" "$@"
    fi
    setup_step building 0 cmake --build "$here/build/$preset" --target "$target"
    [ $((SECONDS - began)) -lt 2 ] || echo "Built build/$preset in $(setup_time $((SECONDS - began)))." >&2
}

# setup_package OPTION...: makes the Debian packages in build/package, from a copy of the tree: what debian/ builds is what a
# distribution would build. The options are dpkg-buildpackage's.
setup_package() {
    local version made=$here/build/package list=(find . -type f -not -path './build/*' -not -path './out/*' -print0)
    version=$(sed -nE 's/^project\(marotte VERSION ([0-9.]+).*/\1/p' "$here/CMakeLists.txt")
    setup_install "${setup_required_packages[@]}" "${setup_optional_packages[@]}" "${setup_package_packages[@]}"
    if git -C "$here" rev-parse --is-inside-work-tree >/dev/null 2>&1; then
        list=(git ls-files -z --cached --others --exclude-standard --deduplicate)
    fi
    rm -rf "$made"
    mkdir -p "$made/marotte-$version"
    local setup_log=$made/build.log
    (cd "$here" && "${list[@]}" | tar --null --files-from=- --ignore-failed-read --create) |
        tar --extract --directory "$made/marotte-$version"
    setup_step "packing the sources" 0 tar --create --auto-compress --file "$made/marotte_$version.orig.tar.xz" \
        --directory "$made" --exclude="marotte-$version/debian" --sort=name --owner=0 --group=0 --numeric-owner \
        --mtime="@$(dpkg-parsechangelog -l "$here/debian/changelog" -S Timestamp)" "marotte-$version"
    setup_step packaging 0 env --chdir="$made/marotte-$version" dpkg-buildpackage --no-sign "$@"
    rm -r "$made/marotte-$version"
    (cd "$here" && du -k --apparent-size build/package/*.deb | sed 's/\t/ KiB  /')
}

# setup_install_tests [PACKAGE...]: installs what all tests need, and each PACKAGE. npm is only installed to fetch its
# packages; without a network, the tests that need them are skipped.
setup_install_tests() {
    setup_install "${setup_required_packages[@]}" "${setup_test_packages[@]}" "$@"
    bash "$here/tests/e2e/setup_packages.sh" --installed || setup_install npm
    bash "$here/tests/e2e/setup_packages.sh" >&2 || true # has printed the reason
}
