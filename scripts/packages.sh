#!/usr/bin/env bash
# packages.sh [BUILD]: makes the Debian packages of a build tree for any processor (build/release, configured with
# -DWITHY_ANY_PROCESSOR=ON) that is up to date, asks lintian, and tries them: unpacked in a folder somewhere, and installed by apt in a bare Debian root where mmdebstrap and the system's package
# sources allow it. Needs lintian, pkg-config and a compiler; some minutes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$(realpath "${1:-build/release}")
for tool in cpack lintian pkg-config dpkg-deb file; do
  command -v "$tool" >/dev/null || { echo "$tool is missing: apt-get install cmake lintian pkg-config dpkg file" >&2; exit 3; }
done

grep -q "^WITHY_ANY_PROCESSOR:BOOL=ON" "$build/CMakeCache.txt" || {
  echo "$build is for processors with AVX2 alone: cmake $build -DWITHY_ANY_PROCESSOR=ON, and build" >&2
  exit 3
}
rm -rf "$build/packages"
(cd "$build" && cpack -G DEB >/dev/null)
mapfile -t packages < <(printf '%s\n' "$build"/packages/*.deb)
lintian --fail-on error "${packages[@]}"
echo "lintian finds no errors in ${packages[*]##*/}"

work=$(mktemp -d /tmp/withy-packages.XXXXXX)
trap 'rm -rf "$work"' EXIT

# The hosts and the scene, and what is done with them: the same in a folder and in a bare root.
mkdir "$work/try"
cp tests/host/c_host.c tests/out_of_tree/project/controller.cpp scenes/commanded-arm.yaml scenes/pendulum.yaml "$work/try"
cat >"$work/try/run.sh" <<'TRY'
set -eu
cd "$(dirname "$0")"
withy run pendulum.yaml --out run >/dev/null
withy fmu commanded-arm.yaml --out arm.fmu >/dev/null
/usr/bin/python3 -c 'import withy; r = withy.load("commanded-arm.yaml").run(); assert r.status == "completed", r.status'
TRY
# Where withy and what it brings are gone: the FMU's library finds all it needs in the FMU and in the system.
cat >"$work/try/load.sh" <<'TRY'
set -eu
cd "$(dirname "$0")"
/usr/bin/python3 -c '
import ctypes, glob, zipfile
zipfile.ZipFile("arm.fmu").extractall("fmu")
[file] = [f for f in glob.glob("fmu/binaries/x86_64-linux/*.so")]
version = ctypes.CDLL(file, 2).fmi3GetVersion
version.restype = ctypes.c_char_p
print("An FMU of the version", version().decode(), "loads where withy is not")'
TRY
cat >"$work/try/build.sh" <<'TRY'
set -eu
cd "$(dirname "$0")"
cc -std=c99 c_host.c -o c_host $(pkg-config --cflags --libs withy-c) -lm "$@"
c++ -std=c++20 controller.cpp -o controller $(pkg-config --cflags --libs withy) "$@"
./c_host commanded-arm.yaml
./controller commanded-arm.yaml
TRY

# Under another prefix: nothing is installed, no path of the system is searched.
tree=$work/moved
for package in "${packages[@]}"; do dpkg-deb -x "$package" "$tree"; done
PATH=$tree/usr/bin:$PATH PYTHONPATH=$tree/usr/lib/python3/dist-packages sh "$work/try/run.sh"
PKG_CONFIG_PATH=$tree/usr/lib/pkgconfig sh "$work/try/build.sh" "-Wl,-rpath,$tree/usr/lib"
echo "In another folder: the program, the FMU, Python, a host in C and one in C++ run"

if ! command -v mmdebstrap >/dev/null; then
  echo "Not tried in a bare root: mmdebstrap is missing (apt-get install mmdebstrap)"
  exit 0
fi
# From where this system gets its own packages.
# shellcheck disable=SC1091
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
mapfile -t from < <(grep -lsw "$suite" /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources})
# shellcheck disable=SC2016
mmdebstrap --quiet --variant=apt --format=null \
  --customize-hook="copy-in ${packages[*]} $work/try /root" \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install /root/libwithy0_* /root/withy_* /root/python3-withy_*"' \
  --customize-hook='chroot "$1" sh /root/try/run.sh' \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install /root/libwithy-dev_* g++ libc6-dev pkg-config"' \
  --customize-hook='chroot "$1" sh /root/try/build.sh' \
  --customize-hook='chroot "$1" sh -c "dpkg --purge python3-withy withy libwithy-dev libwithy0 && ! find / -xdev -name \"*withy*\" -not -path \"/root/*\" -not -path \"/var/lib/*\" | grep ."' \
  --customize-hook='chroot "$1" sh -c "dpkg --purge --force-depends libyaml-cpp0.7 && sh /root/try/load.sh"' \
  "$suite" - "${from[@]}"
echo "In a bare $suite: installed, run, hosts compiled, purged; the FMU loads there"
