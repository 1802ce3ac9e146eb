#!/usr/bin/env bash
# Tries the packages where nothing of the build is: the .deb in a bare Debian root, installed by apt with
# what it asks for, and the folder and the AppImage in bare roots without any package of their own. Called by
# ./plumbline package --test; needs root for the bare roots and a network for what the .deb asks for.
#
# test.sh DEB TARBALL APPIMAGE [ROOT]
#   ROOT: a folder with a bare Debian or Ubuntu; a Debian is made by debootstrap where there is none
set -euo pipefail
deb=$(readlink -f -- "$1") tarball=$(readlink -f -- "$2") appimage=$(readlink -f -- "$3")
bare=${4:-}
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

[[ $(head -c 11 "$appimage" | tail -c 3 | od -A n -t x1) == " 41 49 02" ]] || fail "the AppImage is not of type 2"
mkdir "$work/extracted"
(cd "$work/extracted" && "$appimage" --appimage-extract '*.desktop' && "$appimage" --appimage-extract '*.svg' &&
    "$appimage" --appimage-extract .DirIcon && "$appimage" --appimage-extract AppRun) >/dev/null ||
    fail "the AppImage does not unpack"
for inside in AppRun plumbline.desktop plumbline.svg .DirIcon; do
    [[ -s $work/extracted/squashfs-root/$inside ]] || fail "the AppImage lacks $inside"
done
say "the AppImage is of type 2 and holds what desktops look for: $(du -h "$appimage" | cut -f 1)"

((EUID == 0)) || fail "the bare roots need root: run as root, or take the checks above for all there is"
if [[ -z $bare ]]; then
    command -v debootstrap >/dev/null || fail "debootstrap makes the bare root: apt-get install debootstrap"
    bare=$work/bare
    say "making a bare Debian"
    debootstrap --variant=minbase bookworm "$bare" >"$work/debootstrap.log" 2>&1 ||
        fail "no bare root: $(tail -n 3 "$work/debootstrap.log")"
fi

# shellcheck disable=SC1091  # of that root
name=$(. "$bare/etc/os-release" && echo "$PRETTY_NAME")

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

say "the folder, in a bare $name without any package of its own"
copy_of_bare "$work/folder"
tar --extract --gzip --file "$tarball" --directory "$work/folder/opt"
unpacked=/opt/$(basename -- "$tarball" .tar.gz)
try_out "$work/folder" "$unpacked/plumbline"

say "the AppImage, in a bare $name without any package of its own"
copy_of_bare "$work/image"
install -m 755 "$appimage" "$work/image/opt/Plumbline.AppImage"
try_out "$work/image" /opt/Plumbline.AppImage
kept=$(find "$work/image/root/.cache/plumbline" -mindepth 1 -maxdepth 1 -type d | wc -l)
[[ $kept == 1 ]] || fail "the AppImage was unpacked to $kept folders instead of one"
inside "$work/image" APPIMAGE_EXTRACT_AND_RUN=1 /opt/Plumbline.AppImage --version >&2 ||
    fail "the AppImage does not run from temporary files"
# A byte in its midst that is another one is told, where nothing is unpacked yet.
rm -rf -- "$work/image/root/.cache"
middle=$(($(stat --format %s "$appimage") / 2))
byte=$(od -A n -t u1 -j "$middle" -N 1 "$appimage")
# shellcheck disable=SC2059  # an octal number is written as the byte of that number
printf "\\$(printf '%03o' $((byte ^ 1)))" |
    dd of="$work/image/opt/Plumbline.AppImage" bs=1 seek="$middle" conv=notrunc status=none
if inside "$work/image" /opt/Plumbline.AppImage --version >"$work/out" 2>&1; then fail "a damaged AppImage runs"; fi
grep -q "is damaged" "$work/out" || fail "a damaged AppImage says something else: $(cat "$work/out")"

say "the .deb, installed by apt in a bare $name"
copy_of_bare "$work/installed"
cp -- "$deb" "$work/installed/srv/plumbline.deb"
inside "$work/installed" DEBIAN_FRONTEND=noninteractive sh -c \
    'apt-get -qq update && apt-get -qq install --yes --no-install-recommends /srv/plumbline.deb' \
    >"$work/out" 2>&1 || fail "apt could not install it: $(tail -n 8 "$work/out")"
try_out "$work/installed" plumbline
say "all three start and compute in a bare $name"
