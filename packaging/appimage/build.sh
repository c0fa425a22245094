#!/usr/bin/env bash
# Makes build/appimage/marotte-VERSION-x86_64.AppDir of the portable folder (./run portable makes it), and an AppImage of it where
# appimagetool is on the path: Debian has no package of it. The AppDir itself runs: AppRun.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
portable=$here/build/portable/marotte
[ -d "$portable" ] || { echo "run ./run portable first" >&2; exit 1; }
id=org.marotte.Marotte
version=$(sed -n 's/^project(marotte VERSION \([0-9.]*\).*/\1/p' "$here/CMakeLists.txt")
name=marotte-$version-x86_64
folder=$here/build/appimage/$name.AppDir

rm -rf "$folder"
mkdir -p "$folder/usr"
cp -a "$portable"/{bin,lib,share} "$folder/usr/"
rm -rf "$folder/usr/lib/udev"
# It asks for no sandbox and no portal of its own: devices and folders are those of the person. AppRun is the program, which finds all
# else beside itself.
ln -s usr/bin/marotte "$folder/AppRun"
cp "$portable/share/applications/$id.desktop" "$portable/share/icons/hicolor/scalable/apps/$id.svg" "$folder/"
ln -s "$id.svg" "$folder/.DirIcon"
if command -v appimagetool >/dev/null; then
    ARCH=x86_64 appimagetool "$folder" "$here/build/appimage/$name.AppImage"
else
    echo "wrote ${folder#"$PWD/"}. appimagetool is not on the path, so there is no .AppImage"
fi
