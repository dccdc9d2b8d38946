#!/usr/bin/env bash
# agreement.sh [BUILD]: runs every scene in ways that must not matter, and writes how far the results are apart for
# docs/verification.md; some minutes. BUILD: build/release, else the folder given.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
build=${1:-build/release}
python3 - "$build/bin/withy" <<'PYTHON' | record_table agreement "scripts/agreement.sh" "All scenes of scenes/ and scenes/gallery over 2 s at most, but rigid-chain, whose motion multiplies any rounding. Differences are the greatest of all columns and rows, over the range that a column has in the run; columns that change by less than 1e-4 of their unit are left out, since tolerances are absolute there. Where bits are compared nothing else is."
import csv, glob, json, os, shutil, subprocess, sys, tempfile

PROGRAM, FOLDER = sys.argv[1], tempfile.mkdtemp()
shutil.copytree("scenes", FOLDER + "/scenes")
SCENES = [s for s in sorted(glob.glob("scenes/*.yaml") + glob.glob("scenes/gallery/*.yaml")) if "rigid-chain" not in s]
TIGHT = "{name: dopri5, rtol: 1e-9, atol: 1e-12}"
LEAST_SPAN = 1e-4  # of a column, in its unit, and of the greatest number in it

def run(scene, *options):
    """Columns, rows and run.json; nothing where the run is refused."""
    out = os.path.join(FOLDER, "out")
    shutil.rmtree(out, ignore_errors=True)
    subprocess.run([PROGRAM, "run", scene, "--estimate", "never", "--no-hdf5", "--out", out, *options],
                   capture_output=True)
    if not os.path.exists(out + "/run.json"):
        return None
    with open(out + "/results.csv") as table, open(out + "/run.json") as summary:
        rows = list(csv.reader(table))
        return rows[0], rows[1:], json.load(summary)

def apart(a, b):
    """The greatest difference over its range, and its column; b may have columns of its own."""
    worst, where = 0.0, "—"
    for i, name in enumerate(a[0]):
        if name not in b[0]:
            continue
        other = b[0].index(name)
        if any(not row[i] for row in a[1]) or any(not row[other] for row in b[1]):
            continue  # what is not finite
        values = [float(row[i]) for row in a[1]]
        span = max(values) - min(values)
        if span < LEAST_SPAN * max(1.0, max(map(abs, values))):
            continue
        off = max(abs(x - float(row[other])) for x, row in zip(values, b[1])) / span
        if off > worst:
            worst, where = off, name
    return worst, where

def beside_a_slanted_hinge(scene):
    """The same scene with a body hinged to the world about an axis that lies in no plane of coordinates."""
    with open(scene) as file:
        text = file.read()
    for group, member in (
        ("bodies", "apart: {type: rigid, mass: 0.001, inertia: [0.001, 0.001, 0.001, 0, 0, 0]}"),
        ("hinges", "slanted: {type: revolute, axis: [0.3, 0.5, 0.8], parent: world, child: apart}"),
    ):
        text = text.replace(f"\n{group}:", f"\n{group}:\n  {member}", 1)
    place = os.path.join(FOLDER, scene)  # a copy, which has the files that it names beside it
    with open(place, "w") as file:
        file.write(text)
    return place

def numbers(what, pairs):
    """Prints a line of the table: how far numbers are apart."""
    count, worst, where = 0, 0.0, "—"
    for scene, a, b in pairs:
        if a is None or b is None:
            continue
        count += 1
        off, column = apart(a, b)
        if off > worst:
            worst, where = off, f"`{column}` of {scene}"
    print(what, count, "", f"{worst:.1e}", where, sep="\t")

def bits(what, pairs, other):
    """Prints a line of the table: in how many runs anything is another number."""
    found = [other(a, b) for _, a, b in pairs if a is not None and b is not None]
    print(what, len(found), sum(found), "", "", sep="\t")

def other_rows(a, b):
    return a[1] != b[1]

def other_rows_in_common(a, b):
    times = {r[0]: r for r in b[1]}
    return any(times.get(r[0]) != r for r in a[1])

def end(scene):
    with open(scene) as file:
        found = [w for w in file.read().replace("{", " ").replace(",", " ").split("end:")[1:2]]
    return min(2.0, float(found[0].split()[0])) if found and found[0].split()[0].replace(".", "").isdigit() else 2.0

def pairs(first, second, change=lambda scene: scene):
    for scene in SCENES:
        short = ["--set", f"time.end={end(scene)}"]
        yield os.path.basename(scene)[:-5], run(scene, *short, *first), run(change(scene), *short, *second)

print("what is changed\truns\tother bits\tgreatest difference\tof")
tight = ["--set", "integrator=" + TIGHT]
for method in ("dopri5", "dop853", "rk4-adaptive", "radau", "imex", "rosenbrock-w", "cvode"):
    chosen = ["--set", f"integrator={{name: {method}, rtol: 1e-6, atol: 1e-9}}"]
    numbers(f"`{method}` at 1e-6 against `dopri5` at 1e-9", pairs(tight, chosen))
numbers("spatial sweeps in the place of planar ones", pairs(tight, tight, beside_a_slanted_hinge))
bits("two threads in the place of one", pairs([], ["--threads", "2"]), other_rows)
seldom, often = (["--set", f"time.output={interval}"] for interval in (0.25, 0.0625))
bits("rows four times as often", pairs(seldom, often), other_rows_in_common)
shutil.rmtree(FOLDER)
PYTHON
scripts/docs.sh
