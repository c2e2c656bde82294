#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds for aarch64 with a cross compiler and runs tests of visibility, cover and pieces under emulation.
# Usage: check-aarch64.sh BUILD gcc|clang JOBS. As root, for debootstrap.
#
# The libraries are Debian's for arm64, unpacked into BUILD/root without being installed.
set -eu
cd "$(dirname "$0")/.."
mkdir -p "$1"
build=$(cd "$1" && pwd)
compiler=$2
jobs=$3
root=$build/root
library=$root/usr/lib/aarch64-linux-gnu
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
tests="test_visibility test_box_visibility test_visibility_adversarial test_predicates test_cover
    test_cover_exhaustive test_cover_stages test_kernel test_bsp_start test_decomposition"

mirror() {
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1
}

unpack_root() {
    debootstrap --foreign --arch=arm64 --variant=minbase --include=libc6-dev,libstdc++-12-dev,coinor-libcbc-dev,libjansson-dev,zlib1g-dev,libsqlite3-dev,libarpack2-dev,libsuitesparse-dev,libcmocka-dev,libgmp-dev \
        "$suite" "$root" "$(mirror)" >"$build/debootstrap.log" 2>&1 || {
        tail -n 20 "$build/debootstrap.log" >&2
        exit 1
    }
    for package in "$root"/var/cache/apt/archives/*.deb; do
        dpkg-deb --extract "$package" "$root"
    done
    ln -sf blas/libblas.so.3 "$library/libblas.so.3" # what update-alternatives does
    ln -sf lapack/liblapack.so.3 "$library/liblapack.so.3"
    touch "$build/unpacked"
}

[ -e "$build/unpacked" ] || unpack_root
case $compiler in
gcc) options="-DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc" ;;
clang) options="-DCMAKE_C_COMPILER=clang -DCMAKE_C_COMPILER_TARGET=aarch64-linux-gnu" ;;
esac
export PKG_CONFIG_SYSROOT_DIR="$root" PKG_CONFIG_LIBDIR="$library/pkgconfig:$root/usr/share/pkgconfig"
# shellcheck disable=SC2086
cmake -G Ninja -S . -B "$build/$compiler" $options -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_SYSTEM_NAME=Linux \
    -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_SYSROOT="$root" -DCMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu \
    -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY \
    -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_FIND_ROOT_PATH="$root" \
    -DCMAKE_CROSSCOMPILING_EMULATOR="qemu-aarch64-static;-L;$root" -DSTARGUARD_VIEWER=OFF >"$build/configure.log" 2>&1 || {
    tail -n 20 "$build/configure.log" >&2
    exit 1
}
# shellcheck disable=SC2086
cmake --build "$build/$compiler" -j "$jobs" --target $tests
pattern=$(echo "$tests" | tr -s ' \n' '|')
ctest --test-dir "$build/$compiler" -j "$jobs" --output-on-failure -R "/($pattern)\$"
