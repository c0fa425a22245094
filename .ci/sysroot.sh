#!/usr/bin/env bash
# sysroot.sh ARCHITECTURE FOLDER: unpacks the libraries of another Debian architecture into FOLDER, for a cross compiler and
# qemu-user. Only FOLDER changes: apt-get keeps its state below it, and installs nothing. Does nothing where FOLDER is complete.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$here/.ci/setup.sh"
architecture=$1 folder=$2

packages=(libcmocka-dev libstdc++6)
for package in "${setup_required_packages[@]}"; do
    case $package in lib* | *-dev) packages+=("$package") ;; esac # not the programs, which run here
done
wanted=$folder/apt/packages
[ "$(cat "$wanted" 2>/dev/null)" != "${packages[*]}" ] || exit 0

mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial"
cd "$folder"
: >apt/status
apt=(apt-get -q -o APT::Architecture="$architecture" -o APT::Architectures="$architecture" -o APT::Sandbox::User=
    -o Debug::NoLocking=true -o Dir::State="$PWD/apt" -o Dir::State::status="$PWD/apt/status" -o Dir::Cache="$PWD/apt/cache")
"${apt[@]}" update
"${apt[@]}" install -y --no-install-recommends --download-only "${packages[@]}"

for name in bin lib sbin; do
    mkdir -p "usr/$name"
    ln -sfn "usr/$name" $name
done
for package in apt/cache/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" |
        tar -x --keep-directory-symlink --no-same-owner --exclude './usr/share/doc' --exclude './usr/share/locale' --exclude './usr/share/man'
done
rm -r apt/cache
# What installing would do: the library that stands for an interface, and links that begin at the sysroot.
for library in usr/lib/*/blas/*.so* usr/lib/*/lapack/*.so*; do
    ln -sf "$(basename "$(dirname "$library")")/${library##*/}" "$(dirname "$(dirname "$library")")/${library##*/}"
done
while read -r link; do
    ln -sfnr "$PWD$(readlink "$link")" "$link"
done < <(find usr -type l -lname '/*')
echo "${packages[*]}" >"$wanted"
