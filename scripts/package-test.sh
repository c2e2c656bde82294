#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the Debian packages, installs them on a clean root and tests them there: the program, and a C
# program compiled with pkg-config. Usage: package-test.sh BUILD
#
# As root with debootstrap, the clean root is a minimal Debian of the running suite, where apt installs
# the dependencies. Otherwise the package is unpacked into an empty folder and uses this machine's
# libraries.
set -eu
cd "$(dirname "$0")/.."
mkdir -p "$1/package"
build=$(cd "$1/package" && pwd)
scratch=$(mktemp -d "${TMPDIR:-/tmp}/starguard-package.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# Runs a command; shows its output only if it fails.
quietly() {
    "$@" >"$scratch/log" 2>&1 || {
        tail -n 20 "$scratch/log" >&2
        exit 1
    }
}

make_package() {
    quietly cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DCMAKE_INSTALL_PREFIX=/usr -DSTARGUARD_TESTS=OFF
    quietly cmake --build "$build"
    rm -f "$build"/*.deb
    (cd "$build" && quietly cpack -G DEB)
    : >"$scratch/contents"
    for package in "$build"/*.deb; do
        dpkg-deb --field "$package" Package Version Architecture Installed-Size Depends
        dpkg-deb --contents "$package" >>"$scratch/contents"
    done
    for part in bin/starguard /libstarguard.so /libstarguard-shapes.so /libstarguard.a \
        /libstarguard-shapes.a include/starguard/starguard.h \
        pkgconfig/starguard.pc pkgconfig/starguard-shapes.pc starguardConfig.cmake man1/starguard-guard.1 \
        bash-completion/completions/starguard doc/starguard/copyright doc/starguard/docs/README.md \
        docs/fields.md docs/c-api.md docs/python-api.md schema/guards.schema.json; do
        grep -q "$part" "$scratch/contents" || { echo "not in the package: $part" >&2; exit 1; }
    done
}

# The steps of a new user; also for a shell without this script's environment.
cat >"$scratch/use.sh" <<'USE'
set -eu
starguard --version
starguard sample gallery --vertices 1000 -o gallery.off --quiet
starguard guard gallery.off -o guards.json
starguard verify gallery.off guards.json
starguard decompose gallery.off -o pieces.vtk --report pieces.json --time-limit 2
starguard verify gallery.off pieces.vtk pieces.json
gcc guards.c -o guards $(pkg-config --cflags --libs starguard)
./guards gallery.off
gcc match.c -o match $(pkg-config --cflags --libs starguard-shapes)
./match gallery.off gallery.off
USE

# The mirror that apt uses for packages other than security updates.
mirror() {
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1
}

try_clean_root() {
    root=$scratch/root
    suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
    echo "Installing on a minimal Debian $suite"
    quietly debootstrap --variant=minbase --include=gcc,libc6-dev,pkg-config "$suite" "$root" "$(mirror)"
    cp "$build"/*.deb "$scratch/use.sh" examples/guards.c examples/match.c "$root/tmp"
    quietly chroot "$root" sh -c 'apt-get install -y --no-install-recommends /tmp/*.deb'
    chroot "$root" sh -c 'cd /tmp && sh use.sh'
    quietly chroot "$root" sh -c 'apt-get purge -y starguard libstarguard libstarguard-shapes libstarguard-dev'
    left=$(find "$root/usr" -name '*starguard*')
    [ -z "$left" ] || { echo "left behind: $left" >&2; exit 1; }
}

try_empty_folder() {
    echo "Unpacking into an empty folder (no root or no debootstrap for a clean system)"
    for package in "$build"/*.deb; do
        dpkg-deb --extract "$package" "$scratch/root"
    done
    library=$(dirname "$scratch"/root/usr/lib/*/libstarguard.so)
    cp "$scratch/use.sh" examples/guards.c examples/match.c "$scratch/root"
    (cd "$scratch/root" && PATH=$scratch/root/usr/bin:$PATH LD_LIBRARY_PATH=$library \
        PKG_CONFIG_PATH=$library/pkgconfig sh use.sh)
}

make_package
if [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null; then
    try_clean_root
else
    try_empty_folder
fi
echo "package: fine"
