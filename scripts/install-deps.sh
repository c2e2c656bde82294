#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs missing Debian packages, as root or with sudo.
# Usage: install-deps.sh build|check|coverage|memory|mpi|wheel|aarch64|web|site|bench ...
set -eu
export DEBIAN_FRONTEND=noninteractive

# Node.js bundles the viewer; other distributions of it include npm and work as well.
viewer_packages() {
    command -v node >/dev/null || echo nodejs
    command -v npm >/dev/null || echo npm
}

packages=""
for purpose in "$@"; do
    case $purpose in
    build) packages="$packages gcc g++ cmake ninja-build pkg-config coinor-libcbc-dev libjansson-dev zlib1g-dev libsqlite3-dev libspectra-dev libeigen3-dev libsuitesparse-dev libassimp-dev python3 python3-numpy $(viewer_packages)" ;;
    check) packages="$packages libcmocka-dev libgmp-dev cppcheck clang clang-format clang-tidy libclang-rt-14-dev llvm python3-jsonschema jq man-db tetgen chromium python3-pip python3-cffi mypy python3-vtk9 python3-meshio assimp-utils" ;;
    coverage) packages="$packages gcovr" ;;
    memory) packages="$packages valgrind" ;;
    mpi) packages="$packages libopenmpi-dev openmpi-bin" ;;
    wheel) packages="$packages patchelf binutils debootstrap python3-pip" ;;
    aarch64) packages="$packages gcc-aarch64-linux-gnu g++-aarch64-linux-gnu qemu-user-static" ;;
    web) packages="$packages emscripten dpkg-dev" ;;
    site) packages="$packages mkdocs python3" ;;
    bench) packages="$packages libembree-dev hyperfine" ;;
    *) echo "install-deps.sh: unknown purpose '$purpose'" >&2; exit 1 ;;
    esac
done

missing=""
for package in $packages; do
    # A line for each available architecture.
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed ||
        missing="$missing $package"
done
[ -n "$missing" ] || exit 0

sudo=""
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
        echo "These packages are missing, and installing them takes root or sudo:$missing" >&2
        exit 1
    }
    sudo="sudo"
fi
echo "Installing:$missing"
$sudo apt-get update -qq
# shellcheck disable=SC2086
$sudo apt-get install -y -qq --no-install-recommends $missing >/dev/null
