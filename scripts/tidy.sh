#!/usr/bin/env bash
# tidy.sh [FILE...]: clang-tidy on these sources, or on all but the tests. Sources of one folder are read twelve at a time:
# the headers that all of them include take most of the time, and ten sources 17 s so in the place of 88 s. Where that
# finds something, or their names clash, it says so, each is read by itself, and what that finds counts.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.cpp' ':!tests')
# A configuration of its own, not built: clang does not read what g++ precompiles.
cmake --preset release -B build/tidy -DWITHY_PRECOMPILE_HEADERS=OFF --log-level=WARNING >/dev/null
# One flag of g++ it refuses to read (core/CMakeLists.txt).
sed -i 's/ -flive-range-shrinkage//' build/tidy/compile_commands.json

# Units of sources with the same folder and flags, and the commands that compile them.
printf '%s\0' "${files[@]:-$@}" | python3 -c '
import json, pathlib, sys
most = 12
top, units = pathlib.Path.cwd(), pathlib.Path("build/tidy/united")
commands = {entry["file"]: entry for entry in json.load(open("build/tidy/compile_commands.json"))}
rooms = {}
for name in filter(None, sys.stdin.read().split("\0")):
    source = str(top / name)
    if source not in commands:
        sys.exit(f"tidy.sh: {name} is no source of the build")
    rooms.setdefault((pathlib.Path(name).parent, commands[source]["command"].split(" -o ")[0]), []).append(source)
units.mkdir(exist_ok=True)
for old in units.iterdir():
    old.unlink()
made = []
for (folder, flags), sources in rooms.items():
    for first in range(0, len(sources), most):
        unit = top / units / f"{len(made)}.cpp"
        unit.write_text("".join(f"#include \"{source}\"\n" for source in sources[first:first + most]))
        made.append({"directory": str(top / "build/tidy"), "file": str(unit), "command": f"{flags} -o unit.o -c {unit}"})
(units / "compile_commands.json").write_text(json.dumps(made))
'

# tidy DATABASE SOURCE...: the build's flags are those of g++: clang need not know all of its warnings. What it counts in
# system headers is noise. Units include sources as if they were headers.
tidy() {
  clang-tidy -p "$1" --quiet --header-filter='/(core|plugins|bodies|integrators|loads|scene|apps)/.*\.hpp$|/withy/.*\.cpp$|'"$PWD"'/.*\.cpp$' \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument "${@:2}" \
    2> >(grep -vE '^[0-9]+ warnings? generated\.$' >&2)
}
tidy_unit() {
  local found
  found=$(tidy build/tidy/united "$1" 2>/dev/null) && return
  echo "sources are read one by one for: $(grep -m 1 ' error: ' <<<"$found")"
  sed -E 's/#include "(.*)"/\1/' "$1" | while read -r source; do tidy build/tidy "$source" || exit 1; done
}
export -f tidy tidy_unit
find build/tidy/united -name '*.cpp' -print0 | xargs -0 -n 1 -P "$(nproc)" bash -c 'set -o pipefail; tidy_unit "$1"' _
