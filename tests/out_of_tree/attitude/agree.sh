# agree.sh PREFIX FOLDER FMI_HEADERS CC CXX PYTHON [FLAG...]: the attitude loop through every door of an installed withy, as
# docs/attitude-loop.md says; a PYTHON that is empty leaves that door out. The numbers of all doors must be the same.
set -eu
prefix=$1 folder=$2 headers=$3 cc=$4 cxx=$5 python=$6
shift 6
here=$(cd "$(dirname "$0")" && pwd)
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
rm -rf "$folder"
mkdir -p "$folder/fmu"
cd "$folder"

# shellcheck disable=SC2046
"$cxx" -std=c++20 "$here/controller.cpp" -o in_cpp $(pkg-config --cflags --libs withy) "-Wl,-rpath,$prefix/lib" "$@"
# shellcheck disable=SC2046
"$cc" -std=c99 "$here/controller.c" -o in_c $(pkg-config --cflags --libs withy-c) "-Wl,-rpath,$prefix/lib" "$@"
"$cc" -std=gnu11 -I "$headers" "$here/master.c" -o master -ldl "$@"
"$prefix/bin/withy" fmu "$here/attitude.yaml" --fmi 3 --kind cs --out craft.fmu
(cd fmu && cmake -E tar xf ../craft.fmu)

./in_cpp "$here/attitude.yaml" >cpp.csv
./in_c "$here/attitude.yaml" >c.csv
./master fmu craft >fmu.csv
cmp cpp.csv c.csv
if [ -n "$python" ]; then
  PYTHONPATH="$prefix/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 \
    "$python" "$here/controller.py" "$here/attitude.yaml" >python.csv
  cmp cpp.csv python.csv
fi
# An FMU need not have the compiler's code of the libraries: to rounding.
paste -d, cpp.csv fmu.csv | awk -F, '
  NR > 1 {
    for (i = 1; i <= 6; ++i) {
      d = $i - $(i + 6)
      if (d < 0) d = -d
      if (!(d <= 1e-12)) { printf "row %d, column %d: %s and by the FMU %s\n", NR, i, $i, $(i + 6); exit 1 }
      if (d > most) most = d
    }
  }
  # On target: the integral has learnt the pressure, the booms are at rest.
  END {
    if (NR != 961 || !($2 > 0.999999999) || !($6 < 1e-3 && $6 > -1e-3)) { print "not on target: " $0; exit 1 }
    printf "every door agrees; the FMU within %g; at 120 s %.4f deg off target\n", most, 57.29577951308232 * 2 * sqrt($3^2 + $4^2 + $5^2)
  }'
