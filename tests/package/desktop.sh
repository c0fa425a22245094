#!/usr/bin/env bash
# What an installation has for desktops is valid, and does what it says: the menu's entry, the icons, types of files found by their
# content, the description for software centres, thumbnails of shows. One version is written everywhere.
source "$(dirname "$0")/../e2e/lib.sh"
cd "$scratch" || exit 1
id=org.marotte.Marotte share=$scratch/prefix/share
skipped=""
has() { # PROGRAM PACKAGE
    command -v "$1" >/dev/null || { skipped+=" $2"; return 1; }
}
cmake --install "$BUILD_DIR" --prefix "$scratch/prefix" >log 2>&1 || { fail "cmake --install: $(tail -n 3 log)"; finish; }

# ---- one version ----
version=$("$MAROTTE" --version | cut -d ' ' -f 2)
grep -q "<release version=\"$version\" date=\"20[0-9-]*\"" "$share/metainfo/$id.metainfo.xml" || fail "the newest release of $id.metainfo.xml is not $version"
[ "$(sed -nE '1s/.*\(([0-9.]+)-[0-9]+\).*/\1/p' "$SOURCE_DIR/debian/changelog")" = "$version" ] || fail "debian/changelog begins with another version than $version"

# ---- the entry of the menu: it opens the types that it names ----
entry=$share/applications/$id.desktop
types=$(sed -n 's/^MimeType=//p' "$entry" | tr ';' '\n')
if has desktop-file-validate desktop-file-utils; then
    said=$(desktop-file-validate "$entry" 2>&1)
    [ -z "$said" ] || fail "$said"
fi
grep -qx 'Exec=marotte %f' "$entry" || fail "a double click opens nothing: $(grep Exec= "$entry")"
for type in application/vnd.marotte.show+sqlite3 application/vnd.marotte.rig+json; do
    grep -qx "$type" <<<"$types" || fail "the menu's entry does not open $type"
    grep -q "<mediatype>$type</mediatype>" "$share/metainfo/$id.metainfo.xml" || fail "software centres do not know that it opens $type"
done

# ---- icons ----
icon=$(sed -n 's/^Icon=//p' "$entry")
[ -s "$share/icons/hicolor/scalable/apps/$icon.svg" ] && [ -s "$share/icons/hicolor/symbolic/apps/$icon-symbolic.svg" ] || fail "no drawn icon $icon"
if has rsvg-convert librsvg2-bin; then
    for size in 16 24 32 48 64 96 128 256 512; do
        file=$share/icons/hicolor/${size}x$size/apps/$icon.png
        # Of a PNG: width and height, big-endian, after 16 bytes.
        [ "$(od -An -tu1 -j16 -N8 "$file" | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }')" = "${size}x$size" ] || fail "$file"
    done
fi

# ---- types of files: by their content, without a name ----
"$MAROTTE" perform --face "$puppet" --input "log:$demo,end=1" --map one_hand --record a.marotte >/dev/null 2>stderr || fail "a show: $(cat stderr)"
if has update-mime-database shared-mime-info && has gio libglib2.0-bin; then
    update-mime-database "$share/mime" 2>said || fail "update-mime-database: $(cat said)"
    cp a.marotte nameless_show && cp "$puppet" nameless_rig && cp "$puppet" b.rig.json
    echo '{"marotte": "no rig"}' >other.json
    type_of() {
        XDG_DATA_HOME=$share XDG_DATA_DIRS=/usr/share gio info -a standard::content-type "$1" | sed -n 's/^ *standard::content-type: //p'
    }
    for file in a.marotte nameless_show; do
        [ "$(type_of $file)" = application/vnd.marotte.show+sqlite3 ] || fail "$file is taken for $(type_of $file)"
    done
    for file in b.rig.json nameless_rig; do
        [ "$(type_of $file)" = application/vnd.marotte.rig+json ] || fail "$file is taken for $(type_of $file)"
    done
    [ "$(type_of other.json)" = application/json ] || fail "a JSON file is taken for $(type_of other.json)"
fi

# ---- the description for software centres, with pictures where the web has them ----
if has appstreamcli appstream; then
    appstreamcli validate --no-net "$share/metainfo/$id.metainfo.xml" >said 2>&1 || fail "$(cat said)"
    grep -q '^[EWI]:' said && fail "$(cat said)"
    sed 's|@MAROTTE_PICTURES_URL@|https://example.org/pictures|' "$SOURCE_DIR/ui/desktop/$id.metainfo.xml" >"$id.metainfo.xml"
    appstreamcli validate --no-net "$id.metainfo.xml" >said 2>&1 || fail "with pictures: $(cat said)"
    grep -q '^[EWI]:' said && fail "with pictures: $(cat said)"
fi
for picture in $(sed -n 's|.*@MAROTTE_PICTURES_URL@/\([a-z_.]*\)</image>.*|\1|p' "$SOURCE_DIR/ui/desktop/$id.metainfo.xml"); do
    [ -s "$SOURCE_DIR/.github/$picture" ] || fail "software centres would look for .github/$picture"
done

# ---- a thumbnail: file managers give a name without an ending ----
thumbnail() {
    "$scratch/prefix/bin/marotte-thumbnail" "$1" thumbnail 128 >said 2>&1
}
if thumbnail a.marotte; then
    [ "$(od -An -tu1 -j16 -N8 thumbnail | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }')" = 128x128 ] || fail "a thumbnail of another size"
elif grep -q EGL said; then
    skipped+=" libegl1"
else
    fail "no thumbnail: $(cat said)"
fi
echo "no show" >broken.marotte
thumbnail broken.marotte && fail "a thumbnail of what is no show"
[ -z "$skipped" ] || echo "SKIPPED: parts of this test need the packages$skipped"
[ -z "$skipped" ] || [ "$failures" -gt 0 ] || exit 77
finish
