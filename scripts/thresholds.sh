#!/usr/bin/env bash
# Measures up to where each formulation holds: docs/measured/threshold-frequencies.txt of the frequencies of a rotating
# blade, threshold-runs.txt of the spin-up of one; and puts them into the pages. Some seconds.
source "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"
source scripts/measured.sh
need_packages "${build_packages[@]}"
build release withy

# threshold NAME SCENE OPTIONS…: the rows of limit.json.
threshold() {
  local name=$1 folder=results/thresholds/$1
  shift
  mkdir -p "$folder"
  build/release/bin/withy trade "$@" --out "$folder" >"$folder.txt"
  python3 - "$folder/limit.json" <<'PYTHON' | record_table "$name" "withy trade $*" "$(sed -n '/^Reference/p' "$folder.txt")"
import json, sys
study = json.load(open(sys.argv[1]))
cells = {"formulation": "formulation", "modes": "modes", "mode": "mode", "value": study["path"] + " [rad/s]",
         "over_frequency_at_rest": "over frequency at rest", "outcome": "outcome"}
rows = study["thresholds"]
keys = [k for k in cells if any(r.get(k) is not None for r in rows)]
print("\t".join(cells[k] for k in keys))
for r in rows:
    print("\t".join("" if r[k] is None else "%.3g" % r[k] if isinstance(r[k], float) else str(r[k]) for k in keys))
PYTHON
}

threshold threshold-frequencies scenes/rotating-blade.yaml --measure frequencies --limit 1% --over spin.axle=0:3.5 --modes 4 \
  --formulations ruthless,inconsistent,linear,consistent,symmetric,quadratic
threshold threshold-runs scenes/spin-up.yaml --limit 2% --over motions.spin.rate=0.5:4 --modes 3 --integrators dopri5 \
  --tolerances 1e-4 --formulations ruthless,linear,symmetric,consistent,quadratic
scripts/docs.sh
