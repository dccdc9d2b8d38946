#!/usr/bin/env bash
# benchmarks.sh [TABLE...]: times evaluations and integrators, and writes the tables of docs/performance.md and
# docs/integrators.md. TABLE: bench-arm, bench-chain, rivals, equal-links, lanes, lane-sweeps, sweep-threads, branches,
# stiff-cost; without one all of them, about ten minutes of a machine that does nothing else. The programs are those of build/release, where the target
# measurements builds them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
bin=build/release/bin
kept=$(mktemp -d)
trap 'rm -rf "$kept"' EXIT

# Medians of CPU time of a program of Google Benchmark with OPTION...: name, tab, ns.
medians() {
  "$bin/$1" "${@:2}" --benchmark_out="$kept/out.json" --benchmark_out_format=json >&2
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

# Growth of rigid chains beside those programs that the build has found: ns a link and the exponent of the whole.
table_rivals() {
  medians bench-chain --benchmark_filter='^(rigid chain|Simbody|RBDL|Pinocchio) 10*$' --benchmark_repetitions=25 | awk -F'\t' '
    { ns[$1] = $2 }
    END {
      print "\t10 links\t100\t1000\texponent from 10 to 1000"
      count = split("rigid chain,Simbody,RBDL,Pinocchio", names, ",")
      for (i = 1; i <= count; ++i) {
        k = names[i]
        if (!(k " 100" in ns)) continue
        printf "%s\t%.0f\t%.0f", i == 1 ? "Withy" : k, ns[k " 10"] / 10, ns[k " 100"] / 100
        if (k " 1000" in ns) printf "\t%.0f\t%.2f\n", ns[k " 1000"] / 1000, log(ns[k " 1000"] / ns[k " 10"]) / log(100)
        else print "\t\t" } }' |
    record_table rivals "scripts/benchmarks.sh rivals"
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

# Wall time on a machine that does nothing else, or it says little.
table_branches() {
  {
    printf 'links on each of two branches\tkind\tone thread [µs]\ttwo threads [µs]\tratio\thanding over [µs]\tpays from [µs]\n'
    each_kind_of_links branches branches_row 10 100 1000
  } | record_table branches "scripts/benchmarks.sh branches"
}
branches_row() {
  bench_links "$1" --threads 2
  python3 - "$kept/bench.json" "$1" "$2" <<'PYTHON'
import json, sys
t = json.load(open(sys.argv[1]))["threads"]
kind = sys.argv[2] if sys.argv[2] == "rigid" else f"`{sys.argv[2]}` beams, 2+2 modes"
print(sys.argv[3], kind, *(f"{t[k] / 1e3:.1f}" for k in ("ns_one_thread", "ns_all_threads")), f"{t['ratio']:.2f}",
      *(f"{t[k] / 1e3:.2g}" for k in ("ns_hand_over", "pays_from_ns")), sep="\t")
PYTHON
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

# Chains of equal links hinged about five axes in turn, on what they hang on: NUMBER KIND PLACE...
chains() {
  python3 - "$@" <<'PYTHON'
import sys
n, beams, places = int(sys.argv[1]), sys.argv[2] != "rigid", sys.argv[3:]
print("format: withy/1\ntime: {end: 1}\nbodies:")
if places != ["world"]:
    print("  hub: {type: rigid, mass: 4, inertia: [1, 2, 3, 0, 0, 0], frames: {left: {position: [-0.3, 0, 0]}, "
          "right: {position: [0.3, 0, 0]}}}")
names = "bcdefg"
for c in range(len(places)):
    for i in range(n):
        if beams:
            print(f"  {names[c]}{i}: {{type: beam, length: 0.4, mass_per_length: 0.5, "
                  "bending_y: {stiffness: 50, modes: 2}, bending_z: {stiffness: 70, modes: 2}}")
        else:
            print(f"  {names[c]}{i}: {{type: rigid, mass: 0.2, center_of_mass: [0.2, 0, 0], inertia: [0.001, 0.003, 0.003, 0, 0, 0], "
                  "frames: {tip: {position: [0.4, 0, 0]}}}")
print("hinges:")
if places != ["world"]:
    print("  float: {type: free, parent: world, child: hub}")
axes = ("0, 0, 1", "0, 1, 0", "0, 0.6, 0.8", "0.6, 0, 0.8", "0, 0.8, 0.6")
for c, place in enumerate(places):
    for i in range(n):
        parent = place if i == 0 else f"{names[c]}{i - 1}.tip"
        print(f"  h{names[c]}{i}: {{type: revolute, axis: [{axes[i % 5]}], parent: {parent}, child: {names[c]}{i}}}")
PYTHON
}
chain() { chains "$1" "$2" world; }
branches() { chains "$1" "$2" hub.left hub.right; }
# each_kind_of_links CHAINS ACTION NUMBER...: ACTION KIND NUMBER for each kind of links and each number of them, with
# their CHAINS in links.yaml.
each_kind_of_links() {
  local made_by=$1 action=$2 kind n
  shift 2
  for kind in rigid ruthless quadratic; do
    for n in "$@"; do
      "$made_by" "$n" "$kind" >"$kept/links.yaml"
      "$action" "$kind" "$n"
    done
  done
}
# bench_links KIND OPTION...: bench.json of those of this kind.
bench_links() { "$bin/withy" bench "$kept/links.yaml" --formulation "${1/rigid/ruthless}" "${@:2}" >"$kept/bench.json"; }

# ns a link, least of three, and the exponents of growth of the whole.
table_equal_links() {
  {
    printf 'chain\t10 links\t1000 links\t10,000 links\texponent from 10 to 1000\tto 10,000\n'
    each_kind_of_links chain three_batches 10 1000 10000 | awk -F'\t' '
      { if (!(($1, $2) in ns) || $3 < ns[$1, $2]) ns[$1, $2] = $3 }
      END {
        split("rigid ruthless quadratic", kinds, " ")
        for (i = 1; i <= 3; ++i) {
          k = kinds[i]
          printf "%s\t%.0f\t%.0f\t%.0f\t%.2f\t%.2f\n", k == "rigid" ? k : "`" k "` beams, 2+2 modes", ns[k, 10] / 10,
                 ns[k, 1000] / 1000, ns[k, 10000] / 10000, log(ns[k, 1000] / ns[k, 10]) / log(100),
                 log(ns[k, 10000] / ns[k, 10]) / log(1000) } }'
  } | record_table equal-links "scripts/benchmarks.sh equal-links"
}

three_batches() {
  for _ in 1 2 3; do
    bench_links "$1"
    printf '%s\t%s\t' "$1" "$2"
    python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["ns_fastest_batch"])' "$kept/bench.json"
  done
}

# CPU time of a sweep, least of five, beside the same with one case at a time, and in four lanes where the machine has
# more: PLAN CASES.
table_lane_sweeps() {
  {
    printf 'plan\tcases\tone at a time\tin lanes\tratio\tin four lanes\tratio\n'
    local plan
    for plan in "driven-arm-tolerances 400" "driven-arm-tolerances 2000" "rigid-chain-masses 40"; do
      # shellcheck disable=SC2086
      python3 - "$bin/withy" "$kept" $plan <<'PYTHON'
import os, re, resource, shutil, subprocess, sys
withy, kept, name, cases = sys.argv[1:]
plan = f"scenes/sweeps/{name}.yaml"
text, cases = re.sub(r"^cases: \d+", f"cases: {cases}", open(plan).read(), flags=re.M), int(cases)
folder = os.path.dirname(os.path.abspath(plan))
text = re.sub(r"^scene: (\S+)", lambda m: "scene: " + os.path.normpath(os.path.join(folder, m.group(1))), text, flags=re.M)

def milliseconds(text, four=False):
    tunables = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F"} if four else {}
    path, store = os.path.join(kept, "plan.yaml"), os.path.join(kept, "store")
    open(path, "w").write(text)
    shutil.rmtree(store, ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([withy, "sweep", "run", path, "--jobs", "1", "--out", store], check=True, capture_output=True,
                   env=os.environ | tunables)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / cases

# By turns, so that what slows the machine down for a while slows down both; of each the least.
ways = ((re.sub(r"^evaluation: in-lanes", "evaluation: one-at-a-time", text, flags=re.M), False), (text, False), (text, True))
alone, lanes, four = map(min, zip(*([milliseconds(*way) for way in ways] for _ in range(5))))
print(f"`{name}.yaml`", f"{cases:,}", f"{alone:.3g}", f"{lanes:.3g}", f"{alone / lanes:.2f}", f"{four:.3g}", f"{alone / four:.2f}", sep="\t")
PYTHON
    done
  } | record_table lane-sweeps "scripts/benchmarks.sh lane-sweeps"
}

# Wall time of a sweep with one thread and with two, least of five, on a machine that does nothing else, or it says little.
table_sweep_threads() {
  {
    printf 'driven arm, cases\tevaluation\tone thread [s]\ttwo threads [s]\tratio\n'
    python3 - "$bin/withy" "$kept" <<'PYTHON'
import os, re, shutil, subprocess, sys, time
withy, kept = sys.argv[1:]
text = open("scenes/sweeps/driven-arm-tolerances.yaml").read()
text = re.sub(r"^scene: .*", "scene: " + os.path.abspath("scenes/driven-arm.yaml"), text, flags=re.M)

def seconds(threads):
    store = os.path.join(kept, "store")
    shutil.rmtree(store, ignore_errors=True)
    before = time.monotonic()
    subprocess.run([withy, "sweep", "run", path, "--jobs", str(threads), "--out", store], check=True, capture_output=True)
    return time.monotonic() - before

path = os.path.join(kept, "plan.yaml")
for evaluation, cases in (("one-at-a-time", 2000), ("in-lanes", 2000), ("in-lanes", 10000)):
    plan = re.sub(r"^cases: \d+", f"cases: {cases}", text, flags=re.M)
    open(path, "w").write(re.sub(r"^evaluation: in-lanes", f"evaluation: {evaluation}", plan, flags=re.M))
    one, two = map(min, zip(*((seconds(1), seconds(2)) for _ in range(5))))
    print(f"{cases:,}", f"`{evaluation}`", f"{one:.3g}", f"{two:.3g}", f"{one / two:.2f}", sep="\t")
PYTHON
  } | record_table sweep-threads "scripts/benchmarks.sh sweep-threads"
}

tables=("$@")
[ $# -gt 0 ] || tables=(bench-arm bench-chain rivals equal-links lanes lane-sweeps sweep-threads branches stiff-cost)
for table in "${tables[@]}"; do
  case $table in
    bench-arm | bench-chain | rivals | equal-links | lanes | lane-sweeps | sweep-threads | branches | stiff-cost) "table_${table//-/_}" ;;
    *)
      echo "benchmarks.sh: no table '$table'" >&2
      exit 2
      ;;
  esac
done
scripts/docs.sh
