#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
# Installs the packages that `make package` made into a clean Debian made by debootstrap, and uses them there: the program,
# a CMake project outside of this one, the Python module. Needs root and the Debian mirror; some 2 GB below WORK.
#   tools/check_package.sh [WORK]     default: build/package/root
# An existing WORK is used again as it is.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$(id -u)" -eq 0 ] || { echo "check_package: run as root: debootstrap and chroot need it" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "check_package: install the Debian package debootstrap" >&2; exit 1; }
packages=build/package/packages
compgen -G "$packages/*.deb" >/dev/null || { echo "check_package: no packages in $packages; run make package" >&2; exit 1; }
root=${1:-build/package/root}
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
sources() { cat /etc/apt/sources.list /etc/apt/sources.list.d/debian* 2>/dev/null || true; }
mirror=${ADIT_MIRROR:-$(sources | awk '/^(deb |URIs:)/ { for (i = 2; i <= NF; i++) if ($i ~ /^http/) { print $i; exit } }')}
[ -n "$mirror" ] || { echo "check_package: no Debian mirror in /etc/apt; set ADIT_MIRROR" >&2; exit 1; }
if [ ! -x "$root/usr/bin/apt-get" ]; then
  mkdir -p "$root"
  debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" 2>&1 || { tail -5 "$root.log" >&2; exit 1; }
  # What lets apt out of here lets it out of there.
  cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
fi
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
mount --bind /proc "$root/proc"
trap 'umount "$root/proc"' EXIT
install -d "$root/tmp/packages" "$root/tmp/consumer"
rm -f "$root"/tmp/packages/*
cp "$packages"/*.deb "$root/tmp/packages"
cp tests/scenarios/install/{CMakeLists.txt,main.cpp} "$root/tmp/consumer"
install -m 755 tools/check_package_inside.sh "$root/tmp/inside.sh"
inside apt-get update -qq
inside bash -c 'apt-get install -y -qq --no-install-recommends --reinstall /tmp/packages/*.deb' >"$root.log" 2>&1 ||
  { tail -20 "$root.log" >&2; exit 1; }
inside /tmp/inside.sh
echo "check_package: the packages work in a clean Debian $suite"
