#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a wheel where there is only Python and NumPy, uses it there, and compares the results with those
# of the build that it was made of. Usage: wheel-test.sh WHEEL BUILD
#
# As root with debootstrap, the clean root is a minimal Debian of the running suite with python3-numpy.
# Otherwise the wheel is installed into an empty folder, and must not take libraries from elsewhere.
set -eu
cd "$(dirname "$0")/.."
wheel=$(realpath "$1")
build=$(realpath "$2")
source=$PWD
scratch=$(mktemp -d "${TMPDIR:-/tmp}/starguard-wheel.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# The mirror that apt uses for packages other than security updates.
mirror() {
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1
}

use_in_clean_root() {
    root=$scratch/root
    place=$root/tmp
    suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
    echo "Installing on a minimal Debian $suite with Python and NumPy"
    debootstrap --variant=minbase --include=python3-numpy "$suite" "$root" "$(mirror)" >"$scratch/log" 2>&1 || {
        tail -n 20 "$scratch/log" >&2
        exit 1
    }
    for thing in "$root"/usr/bin/gcc "$root"/usr/bin/cc "$root"/usr/lib/*/libCbc* \
        "$root"/usr/lib/*/libjansson* "$root"/usr/lib/python3/dist-packages/*cffi*; do
        [ ! -e "$thing" ] || { echo "not a clean root: it has $thing" >&2; exit 1; }
    done
    # pip itself from a file, so that the root needs no more packages.
    cp "$wheel" /usr/share/python-wheels/pip-*.whl README.md scripts/wheel-use.py "$place"
    chroot "$root" sh -c "cd /tmp && PYTHONPATH=\$(ls pip-*.whl) python3 -m pip install -q --no-index \
        --break-system-packages --root-user-action=ignore ./$(basename "$wheel")"
    chroot "$root" sh -c 'cd /tmp && python3 wheel-use.py README.md'
}

use_in_empty_folder() {
    echo "Installing into an empty folder (no root or no debootstrap for a clean system)"
    place=$scratch/place
    mkdir "$place"
    /usr/bin/python3 -m pip install -q --no-index --no-deps --target "$scratch/site" "$wheel"
    (cd "$place" && PYTHONPATH=$scratch/site /usr/bin/python3 -B "$source/scripts/wheel-use.py" "$source/README.md")
}

if [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null; then
    use_in_clean_root
else
    use_in_empty_folder
fi
mkdir "$scratch/native"
(cd "$scratch/native" && PYTHONPATH=$build/python /usr/bin/python3 -B -c '
import starguard
room = starguard.sample("gallery", vertices=1000)
starguard.guard(room).write("guards.json", "model.off")
starguard.decompose(room, effort=50).write("pieces.vtk")')
for result in guards.json pieces.vtk; do
    cmp "$scratch/native/$result" "$place/$result"
done
echo "wheel: fine"
