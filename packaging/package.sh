#!/usr/bin/env bash
# Packages for those who do not build: a .deb for Debian 12 and Ubuntu 24.04 alike where it was built on
# the older one, one folder, as a tarball, that runs from wherever it is unpacked, and the same folder as
# an AppImage, one file that runs by itself. MuJoCo and ONNX Runtime are inside of all three. Called by
# ./plumbline package; everything is written to target/packages.
#
# package.sh PROGRAM VERSION OUT MUJOCO_LIBRARY ONNXRUNTIME_LIBRARY RUNTIME
#   RUNTIME: what the AppImage starts with, built from packaging/runtime
set -euo pipefail
program=$1 version=$2 out=$3 mujoco=$4 onnxruntime=$5 runtime=$6
here=$(cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")" && pwd)
machine=$(dpkg --print-architecture)
work=$(mktemp -d)
# shellcheck disable=SC2064  # the folder is known now
trap "rm -rf -- '$work'" EXIT
mkdir -p "$out"

# What all packages hold besides the program.
put_desktop_files() {
    local share=$1
    install -D -m 644 "$here/plumbline.desktop" "$share/applications/plumbline.desktop"
    install -D -m 644 "$here/plumbline.svg" "$share/icons/hicolor/scalable/apps/plumbline.svg"
    install -D -m 644 "$here/copyright" "$share/doc/plumbline/copyright"
    install -D -m 644 "$here/../LICENSE-MIT" "$share/doc/plumbline/LICENSE-MIT"
    install -D -m 644 "$here/../LICENSE-APACHE" "$share/doc/plumbline/LICENSE-APACHE"
    mkdir -p "$share/doc/plumbline/manual"
    cp "$here"/../docs/*.md "$share/doc/plumbline/manual/"
}

# The program with its two libraries in one folder: it looks for them beside itself.
put_program() {
    local folder=$1
    install -D -m 755 "$program" "$folder/plumbline"
    strip --strip-debug "$folder/plumbline"
    install -m 644 "$mujoco" "$folder/$(basename -- "$mujoco")"
    # ONNX Runtime is opened by its plain name.
    install -m 644 "$onnxruntime" "$folder/libonnxruntime.so"
    install -D -m 644 "$here/../assets/detector/plumbline-detector.onnx" \
        "$folder/assets/detector/plumbline-detector.onnx"
}

# What of the system's libraries the .deb needs, by the packages that they come from, and what is opened
# only when the window is.
depends() {
    local root=$1
    mkdir -p "$work/shlibs/debian"
    printf 'Source: plumbline\n\nPackage: plumbline\nArchitecture: any\n' >"$work/shlibs/debian/control"
    (cd "$work/shlibs" &&
        dpkg-shlibdeps -O --ignore-missing-info -l"$root/usr/lib/plumbline" \
            "$root/usr/lib/plumbline/plumbline" 2>/dev/null) |
        sed -n 's/^shlibs:Depends=//p'
}

make_deb() {
    local root=$work/deb needed deb=$out/plumbline_${version}_$machine.deb
    put_program "$root/usr/lib/plumbline"
    mkdir -p "$root/usr/bin" "$root/DEBIAN"
    ln -s ../lib/plumbline/plumbline "$root/usr/bin/plumbline"
    put_desktop_files "$root/usr/share"
    needed=$(depends "$root")
    [[ -n $needed ]] || { echo "package: the libraries that the program needs could not be told" >&2; exit 1; }
    cat >"$root/DEBIAN/control" <<CONTROL
Package: plumbline
Version: $version
Architecture: $machine
Maintainer: The Plumbline authors <plumbline@localhost>
Installed-Size: $(du -sk --exclude=DEBIAN "$root" | cut -f 1)
Section: science
Priority: optional
Depends: $needed, libxkbcommon-x11-0, libxcursor1, libxrandr2, libxi6, libx11-xcb1, libvulkan1, libegl1
Recommends: mesa-vulkan-drivers, libgl1-mesa-dri, zenity | xdg-desktop-portal
Description: desk tool for the humanoid robot NICO
 Shows what the robot's eyes see, calibrates them, moves the arms, teaches a
 finger to land where it should, grasps, watches drift, and names what the
 model of the robot is missing. With a simulated robot, so that everything can
 be tried without one.
CONTROL
    dpkg-deb -Zgzip --root-owner-group --build "$root" "$deb" >/dev/null
    echo "$deb"
}

# The C library and its loader are always the system's.
is_of_the_c_library() {
    case $1 in
    ld-linux* | libc.so* | libm.so* | libdl.so* | libpthread.so* | librt.so* | libresolv.so* | libutil.so*) return 0 ;;
    esac
    return 1
}

# What talks to the graphics driver or to the display is the system's where it has it; else it stands by.
stands_by() {
    case $1 in
    libGL.so* | libEGL.so* | libGLdispatch.so* | libGLX.so* | libOpenGL.so* | libdrm*.so* | libgbm.so* | libva*.so* | \
        libvdpau.so* | libOpenCL.so* | libvulkan.so* | libX*.so* | libxcb*.so*) return 0 ;;
    esac
    return 1
}

make_folder() {
    local name=plumbline-$version-$machine root
    root=$work/$name
    put_program "$root/lib"
    local library base into
    mkdir -p "$root/standby"
    while read -r library; do
        base=$(basename -- "$library")
        if is_of_the_c_library "$base"; then continue; fi
        into=$root/lib
        if stands_by "$base"; then into=$root/standby; fi
        [[ -e $into/$base ]] || install -m 644 "$(readlink -f -- "$library")" "$into/$base"
    done < <(LD_LIBRARY_PATH="$root/lib" ldd "$root/lib/plumbline" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }')
    # Opened by their names when the window is.
    local opened
    for opened in libxkbcommon.so.0 libxkbcommon-x11.so.0 libXcursor.so.1 libXrandr.so.2 libXi.so.6; do
        library=$(ldconfig -p | awk -v name="$opened" '$1 == name && !found { print $NF; found = 1 }')
        [[ -z $library ]] || install -m 644 "$(readlink -f -- "$library")" "$root/lib/$opened"
    done
    install -m 755 "$here/AppRun" "$root/plumbline"
    put_desktop_files "$root/share"
    tar --create --gzip --owner=0 --group=0 --directory "$work" --file "$out/$name.tar.gz" "$name"
    echo "$out/$name.tar.gz"
}

# The folder as an AppImage of type 2: the runtime, a squashfs of the folder, and a line with the sum of
# both, by which the runtime tells a file that is not whole. It uses up what make_folder left.
make_appimage() {
    local folder=$work/plumbline-$version-$machine image=$out/Plumbline-$version-$(uname -m).AppImage offset
    # At its root an image has what starts it, by this name, and what desktops look for.
    mv -- "$folder/plumbline" "$folder/AppRun"
    cp -- "$here/plumbline.desktop" "$here/plumbline.svg" "$folder/"
    ln -s plumbline.svg "$folder/.DirIcon"
    mksquashfs "$folder" "$work/squashfs" -comp gzip -root-owned -noappend -no-xattrs -no-progress -quiet >&2
    install -m 755 "$runtime" "$image.part"
    # Bytes 8 to 10 of an ELF mean nothing to the kernel; here they say which kind of file this is.
    printf 'AI\002' | dd of="$image.part" bs=1 seek=8 conv=notrunc status=none
    offset=$(stat --format %s "$image.part")
    cat -- "$work/squashfs" >>"$image.part"
    printf '\nplumbline-image sha256 %s\n' "$(sha256sum <"$image.part" | cut -d ' ' -f 1)" >>"$image.part"
    [[ $("$image.part" --appimage-offset) == "$offset" ]] || {
        echo "package: the AppImage does not find its squashfs" >&2
        exit 1
    }
    mv -- "$image.part" "$image"
    echo "$image"
}

make_deb
make_folder
make_appimage
