#!/usr/bin/env bash
# benchmarks.sh [TABLE...]: times evaluations and integrators, and writes the tables of docs/performance.md and
# docs/integrators.md. TABLE: bench-arm, bench-chain, lanes, stiff-cost; without one all of them, about ten minutes of a
# machine that does nothing else. The programs are those of build/release.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
bin=build/release/bin
kept=$(mktemp -d)
trap 'rm -rf "$kept"' EXIT

# Medians of CPU time of a program of Google Benchmark: name, tab, ns.
medians() {
  "$bin/$1" --benchmark_out="$kept/out.json" --benchmark_out_format=json >&2
  python3 - "$kept/out.json" <<'PYTHON'
import json, statistics, sys
times = {}
for b in json.load(open(sys.argv[1]))["benchmarks"]:
    if b.get("run_type", "iteration") == "iteration":
        times.setdefault(b.get("run_name", b["name"]), []).append(b["cpu_time"])
for name, all_times in times.items():
    print(name, statistics.median(all_times), sep="\t")
PYTHON
}

table_bench_arm() {
  medians bench-arm | awk -F'\t' '
    { ns[$1] = $2 }
    function row(name, text, rival, of) {
      if (name in ns) printf "%s\t%.0f\t%.2g%s\n", text, ns[name], ns[name] / ns[rival], of }
    END {
      print "\tns\tagainst its closed form"
      row("closed form ruthless", "closed form, ruthless", "closed form ruthless", "")
      row("closed form consistent", "closed form, strict", "closed form consistent", "")
      row("ruthless", "`ruthless`", "closed form ruthless", "")
      row("inconsistent", "`inconsistent`", "closed form consistent", "")
      row("consistent", "`consistent`", "closed form consistent", "")
      n = split("symmetric quadratic linear exact", others, " ")
      for (i = 1; i <= n; ++i) row(others[i], "`" others[i] "`", "closed form consistent", " of strict") }' |
    record_table bench-arm "scripts/benchmarks.sh bench-arm"
}

# Per link.
table_bench_chain() {
  medians bench-chain | awk -F'\t' '
    { ns[$1] = $2 }
    function per_link(name, n) { return name " " n in ns ? sprintf("%.0f", ns[name " " n] / n) : "" }
    END {
      print "links\trigid\tSimbody\tratio\t`ruthless` beams, 2+2 modes\t`quadratic`\t`consistent`"
      count = split("2 10 30 100 1000 10000", lengths, " ")
      for (i = 1; i <= count; ++i) {
        n = lengths[i]
        ours = per_link("rigid chain", n); theirs = per_link("Simbody", n)
        printf "%s\t%s\t%s\t%s\t%s\t%s\t%s\n", n == 10000 ? "10,000" : n, ours, theirs,
               theirs == "" ? "" : sprintf("%.2f", ns["rigid chain " n] / ns["Simbody " n]),
               per_link("ruthless beams", n), per_link("quadratic beams", n), per_link("consistent beams", n) } }' |
    record_table bench-chain "scripts/benchmarks.sh bench-chain"
}

# Fastest batches.
table_lanes() {
  {
    printf 'scene\tformulation\tone at a time\tin lanes\tratio\n'
    local scene
    for scene in driven-arm gallery/long-chain rigid-chain; do
      local formulation
      for formulation in ruthless quadratic; do
        [ "$scene $formulation" != "rigid-chain ruthless" ] || continue # nothing bends: all formulations are one
        "$bin/withy" bench "scenes/$scene.yaml" --formulation "$formulation" --lanes >"$kept/bench.json"
        python3 - "$kept/bench.json" "$scene" "$formulation" <<'PYTHON'
import json, sys
run = json.load(open(sys.argv[1]))
alone, lanes = run["ns_fastest_batch"], run["lanes"]["ns_fastest_batch"]
print(f"`{sys.argv[2]}`", f"`{sys.argv[3]}`", f"{alone:.0f}", f"{lanes:.0f}", f"{alone / lanes:.1f}", sep="\t")
PYTHON
      done
    done
  } | record_table lanes "scripts/benchmarks.sh lanes"
}

# "TITLE INTEGRATOR rtol T  error E  S steps N evaluations C ms  R x"
table_stiff_cost() {
  {
    printf '\tintegrator\ttolerance\terror\tsteps\tevaluations\tCPU [ms]\tagainst `dopri5`\n'
    "$bin/bench-stiff" |
      sed -nE 's/^(.*[^ ]) +([a-z0-9-]+) +rtol +([^ ]+) +error +([^ ]+) +([0-9]+) steps +([0-9]+) evaluations +([^ ]+) ms +([^ ]+) x$/\1\t`\2`\t\3\t\4\t\5\t\6\t\7\t\8 ×/p' |
      awk -F'\t' -v OFS='\t' '{ $7 = sprintf("%.3g", $7); print }'
  } | record_table stiff-cost "scripts/benchmarks.sh stiff-cost"
}

tables=("$@")
[ $# -gt 0 ] || tables=(bench-arm bench-chain lanes stiff-cost)
for table in "${tables[@]}"; do
  case $table in
    bench-arm | bench-chain | lanes | stiff-cost) "table_${table//-/_}" ;;
    *)
      echo "benchmarks.sh: no table '$table'" >&2
      exit 2
      ;;
  esac
done
scripts/docs.sh
