# What ./run and ./test share: the packages, and the build. Sourced; needs $here, the top folder.
# shellcheck shell=bash

setup_build_packages=(
    build-essential cmake ninja-build pkg-config
    libopenmesh-dev libtinygltf-dev nlohmann-json3-dev libjansson-dev libsuitesparse-dev libpng-dev
    libdraco-dev libmeshoptimizer-dev libjpeg-dev
    libepoxy-dev libegl-dev libfreetype-dev fonts-inter
    libusb-1.0-0-dev libasound2-dev liblo-dev libopenxr-dev libsqlite3-dev zlib1g-dev nettle-dev libsndfile1-dev libsamplerate0-dev portaudio19-dev
    libglfw3-dev libimgui-dev libpipewire-0.3-dev libsystemd-dev
    libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri libglx-mesa0
)
setup_test_packages=(libcmocka-dev sqlite3 libumockdev-dev umockdev liblo-tools clang-format-14 nodejs npm
    xvfb xdotool openbox wmctrl x11-utils picom ffmpeg gdb pipewire pipewire-bin dbus-daemon)

# For ./test --long: the fuzz targets, clang-tidy.
setup_long_packages=(clang libclang-rt-14-dev clang-tidy-14)

# setup_missing PACKAGE...: those that are not installed, a line each.
setup_missing() {
    local package installed
    installed=" $(dpkg-query -W -f '${db:Status-Abbrev}${Package} ' "$@" 2>/dev/null || true)"
    for package in "$@"; do
        case $package in # these may also come from elsewhere
        nodejs) command -v node >/dev/null && continue ;;
        npm) command -v npm >/dev/null && continue ;;
        esac
        [[ $installed == *" ii $package "* ]] || echo "$package"
    done
}

# setup_install run|test: installs what is missing, saying what and why first.
setup_install() {
    local wanted=("${setup_build_packages[@]}") missing=()
    [ "$1" = test ] && wanted+=("${setup_test_packages[@]}")
    [ "${long:-}" = yes ] && wanted+=("${setup_long_packages[@]}")
    if ! command -v dpkg-query >/dev/null; then
        echo "This is not Debian: make sure that these are installed: ${wanted[*]}" >&2
        return 0
    fi
    mapfile -t missing < <(setup_missing "${wanted[@]}")
    [ ${#missing[@]} -eq 0 ] && return 0
    echo "marotte needs these Debian packages to build and run (README.md says what each is for):"
    echo "  ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "Neither root nor sudo is here. Install them as root, then run this again:" >&2
            echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
            exit 1
        fi
        as_root=(sudo)
    fi
    echo "Installing them with ${as_root[*]} apt-get ..."
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 -qq)
    "${apt[@]}" update
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null
}

# setup_build PRESET TARGET [cmake options]: configures once, and again with options; builds; quiet unless it fails.
setup_build() {
    local preset=$1 target=$2 log
    shift 2
    log=$(mktemp)
    if ! (cd "$here" && { [[ $# -eq 0 && -f build/$preset/build.ninja ]] || cmake --preset "$preset" "$@"; } &&
        cmake --build --preset "$preset" --target "$target") >"$log" 2>&1; then
        cat "$log" >&2
        rm -f "$log"
        echo "The build failed." >&2
        exit 1
    fi
    rm -f "$log"
}
