#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the tests of visibility, covers and star-shaped pieces for aarch64, with gcc and with clang, and runs
# them under qemu. Usage: aarch64.sh FOLDER JOBS [COMPILER ...]
#
# The libraries are Debian's for arm64, unpacked into FOLDER/root by an apt of its own: the system neither
# gets them nor learns of another architecture. -O3 without debugging information, as CMake's Release.
set -eu
cd "$(dirname "$0")/.."
mkdir -p "$1"
folder=$(realpath "$1")
jobs=$2
shift 2
[ $# -gt 0 ] || set -- gcc clang
root=$folder/root
libraries=/usr/lib/aarch64-linux-gnu
tests="visibility|visibility_adversarial|box_visibility|predicates|intersect|kernel"
tests="$tests|cover|cover_stages|cover_exhaustive|bound"
tests="$tests|partition|region|cap|eliminate|decomposition|bsp_start|strict|balls|verify_pieces"

# The mirror that apt uses for packages other than security updates.
mirror() {
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1
}

fetch_libraries() {
    suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
    state=$folder/apt
    rm -rf "$root" "$state"
    mkdir -p "$root" "$state/lists/partial" "$state/archives/partial"
    : >"$state/status"
    echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $(mirror) $suite main" >"$state/sources.list"
    cat >"$state/apt.conf" <<CONF
APT::Architecture "arm64";
APT::Architectures "arm64";
APT::Sandbox::User "";
Dir::State "$state";
Dir::State::status "$state/status";
Dir::Cache "$state";
Dir::Etc::SourceList "$state/sources.list";
Dir::Etc::SourceParts "/dev/null";
CONF
    APT_CONFIG=$state/apt.conf apt-get -qq update
    APT_CONFIG=$state/apt.conf apt-get -qq -y --no-install-recommends --download-only install \
        libc6-dev libstdc++-12-dev coinor-libcbc-dev libjansson-dev zlib1g-dev libsqlite3-dev \
        libspectra-dev libeigen3-dev libsuitesparse-dev libcmocka-dev libgmp-dev >/dev/null
    for package in "$state"/archives/*.deb; do
        dpkg-deb --extract "$package" "$root"
    done
    # absolute links, and what installing the packages would choose
    find "$root" -type l -lname '/*' | while read -r link; do
        ln -sfn "$root$(readlink "$link")" "$link"
    done
    (cd "$root$libraries" && ln -sf blas/* lapack/* .)
    touch "$root/complete"
}

build() {
    compiler=$1
    program=aarch64-linux-gnu-gcc
    target=""
    [ "$compiler" != clang ] || { program=clang && target=-DCMAKE_C_COMPILER_TARGET=aarch64-linux-gnu; }
    # shellcheck disable=SC2086
    PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root$libraries/pkgconfig:$root/usr/share/pkgconfig \
        cmake -G Ninja -S . -B "$folder/$compiler" -DCMAKE_BUILD_TYPE=Release -DSTARGUARD_WERROR=ON \
        -DSTARGUARD_VIEWER=OFF -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
        -DCMAKE_SYSROOT="$root" -DCMAKE_C_COMPILER=$program $target \
        -DCMAKE_CROSSCOMPILING_EMULATOR="qemu-aarch64-static;-L;$root" \
        -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
        -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER >"$folder/configure.log" || {
        cat "$folder/configure.log" >&2
        exit 1
    }
    # shellcheck disable=SC2046
    cmake --build "$folder/$compiler" -j "$jobs" --target $(echo "$tests" | tr '|' '\n' | sed s/^/test_/)
}

[ -e "$root/complete" ] || fetch_libraries
for compiler; do
    echo "aarch64 by $compiler"
    build "$compiler"
    ctest --test-dir "$folder/$compiler" -j "$jobs" --output-on-failure -R "^(unit|property)/test_($tests)\$"
done
