#!/usr/bin/env bash
# windows_libraries.sh FOLDER: builds the libraries that Debian does not have for mingw-w64, from Debian's sources, as static
# libraries in FOLDER. Only FOLDER changes: apt-get keeps its state below it. Does nothing where FOLDER is complete.
set -euo pipefail
folder=$1
host=x86_64-w64-mingw32
sources=(jansson cmocka suitesparse sqlite3 nettle libsndfile libsamplerate)
complete=$folder/sources/complete
[ "$(cat "$complete" 2>/dev/null)" != "${sources[*]}" ] || exit 0

mkdir -p "$folder"/{include,lib/pkgconfig} "$folder/sources/lists/partial" "$folder/sources/cache/archives/partial"
prefix=$(cd "$folder" && pwd)
cd "$prefix/sources"
: >status
echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main" >sources.list
apt=(apt-get -q -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null -o APT::Sandbox::User=
    -o Debug::NoLocking=true -o Dir::State="$PWD" -o Dir::State::status="$PWD/status" -o Dir::Cache="$PWD/cache")
"${apt[@]}" update
"${apt[@]}" source --download-only "${sources[@]}"
for name in "${sources[@]}"; do
    [ -d "$name" ] || dpkg-source --no-check -x "$name"_*.dsc "$name"
done

by_cmake() { # SOURCE OPTION...
    local source=$1
    shift
    cmake -G Ninja -S "$source" -B "$source/build" -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=$host-gcc -DCMAKE_CXX_COMPILER=$host-g++ -DCMAKE_RC_COMPILER=$host-windres \
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_POLICY_DEFAULT_CMP0042=NEW -DBUILD_SHARED_LIBS=OFF \
        -DBUILD_TESTING=OFF "$@"
    cmake --build "$source/build" --target install
}
by_cmake jansson -DJANSSON_BUILD_DOCS=OFF -DJANSSON_WITHOUT_TESTS=ON -DJANSSON_EXAMPLES=OFF
by_cmake libsndfile -DENABLE_EXTERNAL_LIBS=OFF -DBUILD_PROGRAMS=OFF -DBUILD_EXAMPLES=OFF -DENABLE_CPACK=OFF
by_cmake libsamplerate -DLIBSAMPLERATE_EXAMPLES=OFF -DLIBSAMPLERATE_INSTALL=ON
by_cmake cmocka -DWITH_STATIC_LIB=ON -DWITH_EXAMPLES=OFF -DUNIT_TESTING=OFF
mv "$prefix/lib/libcmocka-static.a" "$prefix/lib/cmocka.dll.a" # the name in its CMake package, where no file is
rm "$prefix/lib/libcmocka.dll.a"

(cd nettle && ./configure --host=$host --prefix="$prefix" --libdir="$prefix/lib" --disable-shared --disable-assembler \
    --disable-public-key --disable-openssl --disable-documentation && make -j "$(nproc)" libnettle.a nettle.pc && make install-headers install-static install-pkgconfig)
(cd sqlite3 && ./configure --prefix="$prefix" --disable-tcl --disable-readline && make sqlite3.c &&
    $host-gcc -O2 -c sqlite3.c && $host-ar rcs "$prefix/lib/libsqlite3.a" sqlite3.o && cp sqlite3.h "$prefix/include/" &&
    sed 's/-lz//' sqlite3.pc >"$prefix/lib/pkgconfig/sqlite3.pc")
# CHOLMOD without supernodes and partitions, which need BLAS and METIS and which core/face does not use.
(cd suitesparse && for source in SuiteSparse_config/SuiteSparse_config.c AMD/Source/amd_*.c COLAMD/Source/colamd.c CHOLMOD/{Core,Cholesky,Check}/cholmod_*.c; do
    $host-gcc -O2 -ffp-contract=off -DDINT -DNTIMER -DNPARTITION -DNSUPERNODAL -ISuiteSparse_config -IAMD/Include -ICOLAMD/Include \
        -ICHOLMOD/Include -c "$source"
done
    $host-ar rcs "$prefix/lib/libcholmod.a" ./*.o
    cp SuiteSparse_config/*.h AMD/Include/*.h COLAMD/Include/*.h CHOLMOD/Include/*.h "$prefix/include/")
echo "${sources[*]}" >"$complete"
