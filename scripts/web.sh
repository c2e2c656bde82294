#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the page of `make web`: FOLDER/starguard.html. Needs a native build, whose viewer it contains.
# Usage: web.sh NATIVE FOLDER JOBS
set -eu
cd "$(dirname "$0")/.."
mkdir -p "$2"
native=$(realpath "$1")
folder=$(realpath "$2")
[ -d "$native/viewer/node_modules/esbuild" ] || {
    echo "web: this build has no viewer (docs/viewer.md)" >&2
    exit 1
}
scripts/web-sources.sh "$folder/sources"

# Debian's emscripten looks for node-acorn where only Debian's Node.js does by itself; a launcher
# would preprocess twice.
export NODE_PATH="${NODE_PATH:+$NODE_PATH:}/usr/share/nodejs"
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER
emcmake cmake -G Ninja -DCMAKE_BUILD_TYPE=Release -S web -B "$folder" \
    -DSTARGUARD_SOURCES="$folder/sources" -DSTARGUARD_NATIVE="$native" > "$folder/configure.log" 2>&1 || {
    cat "$folder/configure.log" >&2
    exit 1
}
cmake --build "$folder" -j "$3"
