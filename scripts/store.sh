#!/usr/bin/env bash
# store.sh [cluster]: writes, reads and collects the store of a sweep of a million cases and of a hundred million, in a thousand
# segments, and reckons from it what 1,000 nodes would do, for docs/sweep.md. A quarter of an hour, and 25 GB of disk in $TMPDIR.
# cluster: only the reckoning, from the last measurements of the store and of the arm in lanes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
[ $# = 0 ] || [ "$*" = cluster ] || {
  echo "usage: scripts/store.sh [cluster]" >&2
  exit 2
}

measure_stores() {
  local rows folder size
  rows=$(mktemp)
  folder=$(mktemp -d)
  # shellcheck disable=SC2064
  trap "rm -rf '$rows' '$folder'" EXIT
  for size in 1000000 100000000; do
    build/release/bin/bench-store "$folder/store" $size 1000 | sed "s/^/$size\t/" >>"$rows"
    rm -rf "$folder/store"
  done
  python3 - "$rows" <<'PYTHON' | record_table store-size scripts/store.sh 'Results that no run has made, three values and three numbers a case, written by the writer of sweeps; `collect` makes the index, `table.csv` and `statistics.csv`. Memory is the most so far.'
import sys
by = {}
for line in open(sys.argv[1]):
    size, step, *cells = line.rstrip("\n").split("\t")
    by.setdefault(int(size), {})[step] = cells
print("", *(f"{size:,} cases in 1,000 segments" for size in by), sep="\t")
for step in ("write", "index of a shard", "index", "collect"):
    print(step, *(f"{float(r[step][0]):.1f} s, {r[step][1]} MB" for r in by.values()), sep="\t")
print("segments", *(f"{float(r['segments'][0]) / 1e9:.3g} GB" for r in by.values()), sep="\t")
print("`table.csv`", *(f"{float(r['table'][0]) / 1e9:.3g} GB" for r in by.values()), sep="\t")
PYTHON
}

[ $# = 1 ] || measure_stores
machine_of() { sed -n 's/^machine: //p' "docs/measured/$1.txt"; }
python3 - docs/measured/store-size.txt docs/measured/lane-sweeps.txt <<'PYTHON' | record_table store-cluster "scripts/store.sh cluster" "Reckoned from the table above, measured on $(machine_of store-size), and from what the arm costs by the table of [lanes](performance.md#four-cases-at-once), on $(machine_of lane-sweeps)."
import sys
size, nodes, cores, between = 100_000_000, 1000, 2, 10
of = {}
for line in open(sys.argv[1]):
    step, *cells = line.rstrip("\n").split("\t")
    if len(cells) == 2 and step:
        of[step] = float(cells[1].split()[0])
arm = [line.split("\t") for line in open(sys.argv[2]) if line.startswith("`driven-arm")][-1]
case = 1e-3 * float(arm[3])
record = 1e9 * of["segments"] / size
workers = nodes * cores

def hours(seconds):
    return f"{seconds:.3g} s" if seconds < 600 else f"{seconds / 3600:.3g} h"

print("", f"cases of {1e3 * case:.3g} ms, the arm in lanes", "cases of 1 s", sep="\t")
for what, figure in (
        ("wall time of the sweep", lambda s: hours(size * s / workers)),
        ("records a second, of all nodes", lambda s: f"{workers / s:,.0f}"),
        ("written a second, of all nodes", lambda s: f"{workers / s * record / 1e6:.3g} MB"),
        ("syncs a second, each worker one in ten seconds", lambda s: f"{workers / between:.0f}"),
        ("segments made, opened and locked once", lambda s: f"{workers:,}"),
        ("read by each node that goes on", lambda s: f"its own {cores} segments, {record * size / nodes / 1e6:.3g} MB at most"),
        ("`collect` by one process", lambda s: hours(of["collect"])),
        ("its share of the whole", lambda s: f"{100 * of['collect'] / (of['collect'] + size * s / workers):.2g} %")):
    print(what, figure(case), figure(1.0), sep="\t")
PYTHON
scripts/docs.sh
