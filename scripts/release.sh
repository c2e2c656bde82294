#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What a release consists of: source archive, wheel, Debian packages, web page, site, and SHA256SUMS.
#
#   release.sh versions              do all places name the same version?
#   release.sh check                 and is everything committed, and no other commit tagged with it?
#   release.sh collect BUILD OUTPUT  and puts all into OUTPUT, where the wheel is already
#
# `make release` builds and tests wheel and packages in between.
set -eu
cd "$(dirname "$0")/.."

fail() {
    echo "release.sh: $*" >&2
    exit 1
}

version=$(sed -n 's/^#define STARG_VERSION_[A-Z]* //p' include/starguard/version.h | paste -sd .)

check_versions() {
    grep -q "^project(starguard VERSION $version " CMakeLists.txt || fail "CMakeLists.txt is not of version $version"
    grep -q "^version: $version\$" CITATION.cff || fail "CITATION.cff is not of version $version"
    grep -q "^## $version" CHANGELOG.md || fail "CHANGELOG.md has no section $version"
    grep -q "find_package(starguard ${version%.*} " examples/CMakeLists.txt ||
        fail "examples/CMakeLists.txt asks for another version than ${version%.*}"
    [ -f "docs/releases/$version.md" ] || fail "there is no docs/releases/$version.md"
}

check_commit() {
    [ -z "$(git status --porcelain)" ] || fail "there are changes that are not committed (git status)"
    tagged=$(git rev-parse -q --verify "v$version^{commit}" || true)
    if [ -z "$tagged" ]; then
        echo "release: not tagged yet; after the tests: git tag -a v$version -m 'starguard $version'"
    else
        [ "$tagged" = "$(git rev-parse HEAD)" ] || fail "v$version is another commit: raise the version"
    fi
}

collect() {
    wheel=$(ls "$2"/starguard-"$version"-*.whl) || fail "there is no wheel in $2: make wheel"
    git archive --format=tar --prefix="starguard-$version/" HEAD | gzip -9n >"$2/starguard-$version.tar.gz"
    rm -f "$2"/*.deb "$2"/*.html "$2/SHA256SUMS"
    cp "$1"/package/*.deb "$2"
    if [ -f "$1-web/starguard.html" ]; then
        cp "$1-web/starguard.html" "$2/starguard-$version.html"
    else
        echo "release: without the web page, which has not been built"
    fi
    [ -f "$1-site/index.html" ] || fail "there is no site in $1-site: make site"
    tar -C "$(dirname "$1-site")" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner \
        --transform "s,^[^/]*,starguard-$version-site," -cf - "$(basename "$1-site")" |
        gzip -9n >"$2/starguard-$version-site.tar.gz"
    (cd "$2" && sha256sum -- *"$version"* >SHA256SUMS && cat SHA256SUMS)
    echo "release: starguard $version with $(basename "$wheel") is in $2"
}

check_versions
case $1 in
versions) ;;
check) check_commit ;;
collect)
    check_commit
    collect "$2" "$3"
    ;;
*) fail "unknown word '$1'" ;;
esac
