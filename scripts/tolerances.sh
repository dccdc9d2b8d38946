#!/usr/bin/env bash
# tolerances.sh [BUILD]: measures what error a tolerance gives in each integrator, for docs/integrators.md, on the test
# set of Hull and others and three scenes. BUILD: build/release, else the folder given.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
build=${1:-build/release}
# "… of others: METHOD, tolerance T, … median M, greatest G; beside the others at most B; PROBLEM R; …"
"$build/bin/withy-extremes" --only detest | sed -n 's/.*problems of others: \(.*\), tolerance \(1e-[0-9]*\),.*| median /\1\t\2\t/p' |
  awk -F'\t' '
    function plain(x) { return x >= 100 ? sprintf("%d", x) : x }
    { method = $1 == "cvode" ? "`cvode` (bdf)" : $1 ~ /^cvode/ ? "`cvode` (adams)" : "`" $1 "`"
      n = split($3, part, "; ")
      sub(/ *$/, "", part[1]); sub(/greatest /, "", part[1])
      split(part[1], of_all, ", "); part[1] = of_all[1] ", " plain(of_all[2])
      if (!(method in seen)) { seen[method] = 1; order[++methods] = method }
      of[method, $2] = part[1]
      for (i = 3; i <= n; ++i) { sub(/ *$/, "", part[i]); over[method] = over[method] (over[method] == "" ? "" : "; ") part[i] " at " $2 } }
    END {
      print "integrator\t1e-3: median, greatest\t1e-6\t1e-9\tmore than ten times the others"
      for (i = 1; i <= methods; ++i) { m = order[i]; print m "\t" of[m, "1e-3"] "\t" of[m, "1e-6"] "\t" of[m, "1e-9"] "\t" over[m] } }' |
  record_table detest "scripts/tolerances.sh"
scripts/docs.sh
