#!/usr/bin/env bash
# debian.sh [PACKAGES [BASE.tar]]: makes the Debian packages (or reads those in the folder PACKAGES), then checks what a distribution
# would: lintian, hardening, dependencies, size; and on a bare Debian 12 (by debootstrap, or from BASE.tar, which is made if it does not
# exist): apt installs them, an ordinary user runs the tests of debian/tests, and purged they leave nothing but that user's files.
# Needs root and a network. A step of ./test --long.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$here/.ci/setup.sh"
cd "$here" || exit 1
made=${1:-} base=${2:-} failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
[ "$(id -u)" -eq 0 ] || { echo "SKIPPED: only root can make a bare system"; exit 77; }
setup_install lintian blhc debootstrap
if [ -z "$made" ]; then
    setup_package
    made=$here/build/package
fi
version=$(dpkg-parsechangelog -S Version)
program=$(ls "$made/marotte_${version}"_*.deb) header=$(ls "$made/marotte-dev_${version}"_*.deb)

# ---- what a distribution would say ----
changes=$(ls "$made"/marotte_"$version"_*.changes)
lintian --pedantic --suppress-tags bad-distribution-in-changes-file,initial-upload-closes-no-bugs "$changes" >"$made/lintian.txt" 2>&1
cat "$made/lintian.txt"
grep -qE '^[EW]:' "$made/lintian.txt" && fail "lintian has an error or a warning"
blhc --all "$made/build.log" >"$made/blhc.txt" 2>&1 || { fail "blhc: $(tail -n 5 "$made/blhc.txt")"; }
needed=$(dpkg-deb -f "$program" Depends)
for optional in libasound2 libopenxr-loader1 ffmpeg pocketsphinx-en-us; do
    grep -qE "(^|[ ,])$optional\b" <<<"$needed" && fail "the package requires $optional, which is optional"
done
for package in "$program" "$header"; do
    echo "$(basename "$package"): $(($(stat -c %s "$package") / 1024)) KiB, installed $(dpkg-deb -f "$package" Installed-Size) KiB"
done

# ---- a bare Debian ----
root=$(mktemp -d /tmp/marotte-bare-XXXXXX)
mounts=(proc sys dev/pts dev/shm)
leave() {
    local i
    for ((i = ${#mounts[@]} - 1; i >= 0; --i)); do
        ! mountpoint -q "$root/${mounts[i]}" || umount "$root/${mounts[i]}" || umount --lazy "$root/${mounts[i]}"
    done
    grep -q " $root/" /proc/mounts || rm -rf --one-file-system "$root"
}
trap leave EXIT
if [ ! -s "$base" ]; then
    mirror=$(awk '/^URIs:/ { print $2; exit }' /etc/apt/sources.list.d/*.sources 2>/dev/null)
    debootstrap --variant=minbase --include=ca-certificates bookworm "$root" ${mirror:+"$mirror"} >"$made/debootstrap.txt" 2>&1 ||
        { fail "debootstrap: $(tail -n 3 "$made/debootstrap.txt")"; exit 1; }
    [ -z "$base" ] || tar --create --one-file-system --file "$base" --directory "$root" .
else
    tar --extract --file "$base" --directory "$root"
fi
# This machine's way to the network.
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
cp -r /etc/apt/sources.list* /etc/apt/apt.conf.d "$root/etc/apt/" 2>/dev/null
rm -f "$root"/etc/apt/apt.conf.d/docker-*
cp -r /usr/local/share/ca-certificates "$root/usr/local/share/" && cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
mount -t proc proc "$root/proc"
mount -t sysfs sysfs "$root/sys"
mkdir -p "$root/dev/pts" "$root/dev/shm"
mount -t devpts devpts "$root/dev/pts"
mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"
mkdir "$root/packages"
cp "$program" "$header" "$root/packages/"
cp -r debian/tests "$root/packages/tests"

within() { # COMMAND...: as root, in the bare system
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@" </dev/null
}
tests_need() { # TEST: of debian/tests/control, without the packages themselves
    awk -v test="$1" '/^Tests:/ { on = $2 == test } on && /^Depends:/ { sub(/^Depends:/, ""); gsub(/,/, " "); print }' debian/tests/control |
        tr ' ' '\n' | grep -v '^marotte\|^$'
}
within apt-get update -q >"$made/apt.txt" 2>&1 || fail "apt-get update: $(tail -n 3 "$made/apt.txt")"
echo "on a bare system, $(within apt-get install --assume-no --no-install-recommends "/packages/$(basename "$program")" 2>&1 |
    sed -nE 's/^.* ([0-9]+) newly installed.*/\1 packages/p; s/^After this operation, (.*) will be used.*/\1/p' | paste -sd ' ')"
mapfile -t needs < <({ tests_need demo; tests_need plugin; } | sort -u)
within apt-get install -q -y --no-install-recommends "${needs[@]}" >>"$made/apt.txt" 2>&1 || fail "what the tests need: $(tail -n 3 "$made/apt.txt")"
within apt-mark manual "${needs[@]}" >/dev/null
packages_before=$(within dpkg-query -W -f '${Package}\n' | sort)
within bash -c 'apt-get install -q -y --no-install-recommends /packages/*.deb' >"$made/install.txt" 2>&1 ||
    { fail "apt does not install it: $(tail -n 5 "$made/install.txt")"; exit 1; }
sed -nE '/newly installed|additional disk space/p' "$made/install.txt"
within useradd --create-home anna
as_anna() { within runuser -u anna -- env HOME=/home/anna "$@"; }
for test in demo plugin; do
    as_anna timeout 900 bash "/packages/tests/$test" >"$made/$test.txt" 2>&1 || fail "debian/tests/$test: $(tail -n 8 "$made/$test.txt")"
done
as_anna bash -c 'cd && mkdir -p Documents && marotte perform --face puppet --input log:demo,end=1 --map one_hand --record Documents/mine.marotte' >/dev/null 2>&1 ||
    fail "a show at home"
as_anna bash -c 'cd && xvfb-run --auto-servernum marotte Documents/mine.marotte --seconds 2' >"$made/window.txt" 2>&1 || fail "the window: $(tail -n 3 "$made/window.txt")"
as_anna bash -c 'cd && time marotte stage --hidden --seconds 0.1 --face puppet' 2>&1 | sed -n 's/^real\t/the stage opens, draws for 0.1 s and ends in /p'

# ---- nothing is left ----
within apt-get purge -q -y marotte marotte-dev >"$made/purge.txt" 2>&1 || fail "purge: $(tail -n 3 "$made/purge.txt")"
within apt-get -o APT::AutoRemove::SuggestsImportant=false -o APT::AutoRemove::RecommendsImportant=false autoremove -q -y --purge >>"$made/purge.txt" 2>&1
left=$(find "$root" -mindepth 1 -xdev \( -path "$root/packages" -o -path "$root/home" -o -path "$root/var/log" -o -path "$root/proc" \) -prune -o -iname '*marotte*' -print
    grep -rl marotte "$root/usr/share/mime" "$root/usr/share/applications" "$root/etc" 2>/dev/null)
[ -z "$left" ] || fail "these are left: $left"
[ "$(within dpkg-query -W -f '${Package}\n' | sort)" = "$packages_before" ] ||
    fail "packages are left: $(diff <(echo "$packages_before") <(within dpkg-query -W -f '${Package}\n' | sort) | sed -n 's/^> //p' | tr '\n' ' ')"
[ -s "$root/home/anna/Documents/mine.marotte" ] && [ -s "$root/home/anna/.config/marotte/window.json" ] || fail "files of the user are gone"
[ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
echo "$(basename "$program") $(($(stat -c %s "$program") / 1024)) KiB, installed $(dpkg-deb -f "$program" Installed-Size) KiB: installed, performed, purged"
