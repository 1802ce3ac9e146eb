#!/usr/bin/env bash
# Tries the packages where nothing of the build is: the .deb in a bare Debian root, installed by apt with
# what it asks for, and the folder in a bare root without any package of its own. Called by
# ./plumbline package --test; needs root for the bare roots and a network for what the .deb asks for.
#
# test.sh DEB TARBALL [ROOT]   ROOT: a folder with a bare Debian; made by debootstrap where there is none
set -euo pipefail
deb=$(readlink -f -- "$1") tarball=$(readlink -f -- "$2")
bare=${3:-}
fail() { echo "package test: $*" >&2; exit 1; }
say() { echo "package test: $*" >&2; }
work=$(mktemp -d)
mounted=()
clean() {
    local at
    for at in "${mounted[@]}"; do umount -l -- "$at" 2>/dev/null || true; done
    rm -rf -- "$work"
}
trap clean EXIT

# What is inside, told from the package itself.
contents=$(dpkg-deb --contents "$deb")
for inside in usr/bin/plumbline usr/lib/plumbline/plumbline usr/lib/plumbline/libmujoco.so \
    usr/lib/plumbline/libonnxruntime.so usr/share/applications/plumbline.desktop; do
    grep -q -F "./$inside" <<<"$contents" || fail "the .deb lacks $inside"
done
dpkg-deb --field "$deb" Depends | grep -q libopencv || fail "the .deb does not ask for OpenCV"
say "the .deb holds the program and both libraries: $(du -h "$deb" | cut -f 1)"

((EUID == 0)) || fail "the bare roots need root: run as root, or take the checks above for all there is"
if [[ -z $bare ]]; then
    command -v debootstrap >/dev/null || fail "debootstrap makes the bare root: apt-get install debootstrap"
    bare=$work/bare
    say "making a bare Debian"
    debootstrap --variant=minbase bookworm "$bare" >"$work/debootstrap.log" 2>&1 ||
        fail "no bare root: $(tail -n 3 "$work/debootstrap.log")"
fi

# A copy of the bare root, with what a process needs of the kernel, entered with an empty environment.
copy_of_bare() {
    cp -a -- "$bare" "$1"
    local at
    for at in proc dev; do
        mount --bind "/$at" "$1/$at"
        mounted+=("$1/$at")
    done
    cp -L /etc/resolv.conf "$1/etc/resolv.conf" 2>/dev/null || true
}
inside() {
    local root=$1
    shift
    chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/bin:/bin:/usr/sbin:/sbin "$@"
}

# Computes something real: makes images with the renderer, calibrates eyes from them, builds the twin's
# physics, and runs the detector.
try_out() {
    local root=$1 program=$2 board check
    inside "$root" "$program" --version >&2 || fail "$program does not start"
    inside "$root" "$program" sample --out /srv/sample --pairs 12 >"$work/out" 2>&1 ||
        fail "sample: $(tail -n 5 "$work/out")"
    board=$(sed -n 's/.* of \([0-9]*x[0-9]*\) inner corners, \([0-9.]*\) mm.*/\1 --square-mm \2/p' "$work/out")
    # shellcheck disable=SC2086  # two arguments
    inside "$root" "$program" calibrate stereo --left /srv/sample/board/left --right /srv/sample/board/right \
        --board $board --out /srv/eyes.yaml >"$work/out" 2>&1 || fail "calibrate: $(tail -n 5 "$work/out")"
    # Cameras and displays are missing here, which it says; these must be there.
    inside "$root" "$program" doctor >"$work/out" 2>&1 || true
    for check in OpenCV twin "ONNX Runtime" detector; do
        grep -E "^ok +$check  " "$work/out" >&2 || fail "$check does not work: $(cat "$work/out")"
    done
}

say "the folder, in a bare Debian without any package of its own"
copy_of_bare "$work/folder"
tar --extract --gzip --file "$tarball" --directory "$work/folder/opt"
unpacked=/opt/$(basename -- "$tarball" .tar.gz)
try_out "$work/folder" "$unpacked/plumbline"

say "the .deb, installed by apt in a bare Debian"
copy_of_bare "$work/installed"
cp -- "$deb" "$work/installed/srv/plumbline.deb"
inside "$work/installed" DEBIAN_FRONTEND=noninteractive sh -c \
    'apt-get -qq update && apt-get -qq install --yes --no-install-recommends /srv/plumbline.deb' \
    >"$work/out" 2>&1 || fail "apt could not install it: $(tail -n 8 "$work/out")"
try_out "$work/installed" plumbline
say "both start and compute in a bare Debian"
