#!/usr/bin/env bash
# tolerances.sh [BUILD]: measures what error a tolerance gives in each integrator, on the test set of Hull and others and
# three scenes, and the order that each has on stiff equations, for docs/integrators.md. BUILD: build/release, else the
# folder given.
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

# "… equations: METHOD, PROBLEM, λ = … | closed form | gate published ORDERS ± 0.25 | ORDERS"
"$build/bin/withy-extremes" --only stiff-orders |
  sed -nE 's/.*Order on stiff equations: ([a-z0-9-]+), ([^,]+)(, λ = | of stiffness )[^|]*\| closed form \| gate published ([0-9, ]+) ± [0-9.]+ \| (.*[^ ]) *$/\2\t`\1`\t\4\t\5/p' |
  awk -F'\t' '
    BEGIN { print "problem\tintegrator\tpublished\tλ = −1\tλ = −10³\tλ = −10⁶" }
    { n = split($4, of, ", "); print $1 "\t" $2 "\t" $3 "\t" of[1] "\t" of[2] "\t" of[3] }' |
  record_table stiff-orders "scripts/tolerances.sh" "Where explicit methods have no number a step is limited by stability. The oscillator has the stiffness −λ."
scripts/docs.sh
