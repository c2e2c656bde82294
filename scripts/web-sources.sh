#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Fetches and unpacks the Debian sources of the libraries that the page of `make web` contains, once,
# by the machine's own mirror. Its package lists stay as they are.
# Usage: web-sources.sh FOLDER
set -eu
folder=$1
packages="coinutils coinor-osi clp coinor-cgl coinor-cbc jansson zlib"
[ -e "$folder/complete" ] && exit 0

mkdir -p "$folder/apt/lists/partial"
cd "$folder"
apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    grep -v security | sort -u > apt/sources.list
apt() {
    apt-get -qq -o Dir::Etc::sourcelist="$PWD/apt/sources.list" -o Dir::Etc::sourceparts=- \
        -o Dir::State::lists="$PWD/apt/lists" -o APT::Sandbox::User=root "$@"
}
apt update
# shellcheck disable=SC2086
apt source --download-only $packages > /dev/null
for package in $packages; do
    rm -rf "$package"
    dpkg-source --no-check --extract "${package}"_[0-9]*.dsc "$package" > /dev/null 2>&1
done
touch complete
