# pkg_config.sh LIBRARIES FOLDER CC CXX [FLAG...]: hosts built with the flags of an installed tree that was moved.
set -eu
libraries=$1 folder=$2 cc=$3 cxx=$4
shift 4
sources=$(dirname "$0")
export PKG_CONFIG_PATH="$libraries/pkgconfig"
c_flags=$(pkg-config --cflags --libs withy-c)
cpp_flags=$(pkg-config --cflags --libs withy)
# shellcheck disable=SC2086
"$cc" -std=c99 "$sources/../host/c_host.c" -o "$folder/c_host" $c_flags "-Wl,-rpath,$libraries" -lm "$@"
# shellcheck disable=SC2086
"$cxx" -std=c++20 "$sources/project/controller.cpp" -o "$folder/controller_by_pkg_config" $cpp_flags \
  "-Wl,-rpath,$libraries" "$@"
"$folder/c_host" "$sources/../../scenes/commanded-arm.yaml"
"$folder/controller_by_pkg_config" "$sources/../../scenes/commanded-arm.yaml"
