#!/usr/bin/env bash
# check_includes.sh [ROOT]: every #include goes in an allowed direction. Prints each one that does not; exit 1 if any.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

find . \( -path ./build -o -path ./.git \) -prune -o -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' \) -print |
  LC_ALL=C sort | sed 's|^\./||' | tr '\n' '\0' | xargs -0 -r awk '
  BEGIN {
    # Regular expressions over what stands between the quotes or brackets. Standard headers have neither / nor a dot,
    # but for the one of C that POSIX clocks come from.
    standard = "[a-z_0-9]+|time[.]h"
    inner = standard "|(unsupported/)?Eigen/.*|withy/core/.*"

    # Inside the core: each room sees those named before it, and what is named here alone.
    engine = standard "|(unsupported/)?Eigen/.*|boost/math/.*"
    rooms = split("spatial shape plugin model deformation tree sweep sweep/rod sweep/strict sweep/symmetric sweep/first_order sweep/lanes " \
                  "kinematics reference tangents equations simulation analysis", core, " ")
    seen = ""
    for (i = 1; i <= rooms; ++i) {
      seen = seen (i > 1 ? "|" : "") core[i]
      may["core/" core[i]] = engine "|withy/core/(" seen ")/[^/]*"
    }
    may["core/sweep/symmetric"] = engine "|withy/core/(spatial|shape|plugin|model|deformation|tree|sweep|sweep/rod|sweep/symmetric)/[^/]*"
    may["scene"] = inner "|withy/scene/.*|yaml-cpp/.*|nlohmann/.*|fmt/.*|(sys/)?[a-z]+[.]h"
    may["study"] = inner "|withy/(scene|study|plugins/host)/.*|fmt/.*|boost/math/.*"
    may["results"] = inner "|withy/(scene|study|results)/.*|nlohmann/.*|fmt/.*|boost/crc.hpp|hdf5[.]h|(sys/)?[a-z]+[.]h"
    may["campaign"] = inner "|withy/(scene|study|results|campaign)/.*|nlohmann/.*|fmt/.*|boost/(crc[.]hpp|(math|random|context)/.*)|(sys/)?[a-z]+[.]h"
    may["host"] = inner "|withy/(scene|study|results|plugins/host|host)/.*|nlohmann/.*|fmt/.*"
    may["bindings/c"] = inner "|withy/(scene|study|host)/.*|withy/bindings/c/.*|stddef[.]h"
    may["bindings/fmi"] = inner "|withy/(scene|study|results|plugins/host|bindings/fmi)/.*|nlohmann/.*|fmt/.*|minizip/.*|std[a-z]+[.]h"
    may["bindings/fmu_load"] = inner "|withy/(scene|exchange|loads/control|bindings/(fmi/fmi[23][.]h|fmu_load))/?.*|fmt/.*|minizip/.*|dlfcn[.]h"
    may["bindings/python"] = inner "|withy/(scene|study|results|campaign|host|loads|bindings/python)/.*|pybind11/.*"
    may["bindings/modelica"] = "withy/withy.h|ModelicaUtilities.h|std[a-z]+[.]h|string.h"
    may["plugins/formulations"] = inner "|withy/plugins/formulations/.*|fmt/.*"
    may["plugins/kinematics"] = inner "|withy/plugins/kinematics/.*"
    may["plugins/modes"] = inner "|withy/plugins/modes/.*|fmt/.*|boost/math/.*"
    may["plugins/host"] = inner "|withy/plugins/host/.*|fmt/.*|boost/.*|(sys/)?[a-z]+[.]h"
    may["bodies"] = inner "|withy/bodies/.*|fmt/.*|boost/math/.*"
    may["integrators"] = inner "|withy/integrators/.*|fmt/.*|boost/multiprecision/.*|(cvode|nvector|sunmatrix|sunlinsol)/.*"
    may["loads"] = inner "|withy/loads/.*|fmt/.*"
    may["sensors"] = inner "|withy/sensors/.*|fmt/.*"
    may["fem"] = inner "|withy/fem/.*|withy/bodies/modal/.*|fmt/.*|nlohmann/.*|Spectra/.*"
    may["exchange"] = inner "|withy/(scene|exchange)/.*|fmt/.*|expat[.]h"
    may["cmake"] = inner "|withy/(scene|plugins/host)/.*|fmt/.*|nlohmann/.*|gmock/.*|gtest/.*"
    may["withy.hpp"] = inner "|withy/(scene|study|results|plugins/host|host)/.*"
    may["program"] = inner "|withy/(scene|program)/.*|fmt/.*|spdlog/.*|CLI/.*|sanitizer/.*|(sys/)?[a-z]+[.]h"
    may["apps"] = ".*"
    may["tests"] = ".*"

    # Libraries that stay in one room, tests included; but a test of FMUs has CVODE as a host of its own.
    only["yaml-cpp/"] = "scene"
    only["CLI/"] = "program"
    only["spdlog/"] = "program"
    only["hdf5.h"] = "results"
    only["boost/dll"] = "plugins/host"
    only["Spectra/"] = "fem"
    only["expat.h"] = "exchange"
    only["pybind11/"] = "bindings/python"
    only["cvode/"] = "integrators"
  }
  function room_of(file,   parts) {
    split(file, parts, "/")
    if (parts[1] == "core") {
      sub("/[^/]*$", "", file)
      return file
    }
    return parts[1] == "plugins" || parts[1] == "bindings" ? parts[1] "/" parts[2] : parts[1]
  }
  # A file of the same folder, and so of the same room.
  function is_neighbour(target,   path, line, found) {
    if (target ~ /\//) return 0
    path = FILENAME
    sub(/[^\/]*$/, target, path)
    found = (getline line < path) >= 0
    close(path)
    return found
  }
  function complain(what) {
    printf "%s:%d: %s\n", FILENAME, FNR, what
    bad = 1
  }
  FNR == 1 {
    room = room_of(FILENAME)
    if (!(room in may)) complain("the room " room " has no rule in scripts/check_includes.sh")
  }
  /^[ \t]*#[ \t]*include[ \t]*["<]/ && room in may {
    quoted = $0 ~ /^[^"<]*"/
    target = $0
    sub(/^[^"<]*["<]/, "", target)
    sub(/[">].*$/, "", target)
    if (quoted && is_neighbour(target)) next
    if (target !~ ("^(" may[room] ")$")) complain(room " may not include " target)
    if (quoted && target !~ /^withy\// && room != "tests") complain("\"" target "\" is neither a neighbour nor written \"withy/...\"")
    for (prefix in only)
      if (index(target, prefix) == 1 && room != only[prefix] && FILENAME != "tests/fmi/cvode_test.cpp") complain(target " stays in " only[prefix])
  }
  END { exit bad }
' || exit 1
