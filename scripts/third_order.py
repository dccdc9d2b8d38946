#!/usr/bin/env python3
"""third_order.py [PROGRAM]: measures, on the scenes that come along and have 'exact', what terms of third order come to over
a run, beside their size at an instant, into docs/measured. A minute."""
import csv
import json
import math
import pathlib
import re
import statistics
import sys
import tempfile

import recorded

top = pathlib.Path(__file__).resolve().parents[1]
program = recorded.Program(sys.argv[1:])
work = pathlib.Path(tempfile.mkdtemp())
negligible = 1e-5  # share at an instant below which other errors are greater


def run(scene, formulation):
    """The run's account and its deflections [m], a list of vectors a body; nothing where the formulation is refused."""
    out = work / formulation
    program.run("run", scene, "--formulation", formulation, "--set", "integrator.rtol=1e-8", "--estimate", "never", "--out", out, "--force",
                status=(0, 1, 2))
    if not (out / "run.json").exists():
        return None
    told = json.loads((out / "run.json").read_text())
    with open(out / "results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    bodies = sorted({m[1] for name in rows[0] if (m := re.fullmatch(r"(.*)\.tip\.deflection_x\[m\]", name))})
    tips = {b: [[float(row[f"{b}.tip.deflection_{axis}[m]"]) for axis in "xyz"] for row in rows] for b in bodies}
    for file in out.iterdir():
        file.unlink()
    return (told, tips) if told["status"] == "completed" else None


def measured(scene):
    runs = [run(scene, formulation) for formulation in ("quadratic", "exact")]
    if None in runs:
        return None
    (told, approximate), (_, true) = runs
    bend = max((max(b["deflection_over_length"], b.get("section_angle", 0) / 2) for b in told["certificate"]["bodies"]), default=0)
    off = 0
    for body, tip in true.items():
        size = max(math.dist(d, tip[0]) for d in tip)
        if size > 0:
            off = max(off, max(map(math.dist, approximate[body], tip)) / size)
    return bend**2, off


rows, times = [], []
for scene in sorted([*top.glob("scenes/*.yaml"), *top.glob("scenes/gallery/*.yaml")]):
    found = measured(scene)
    if found is None or found[0] < negligible:
        continue
    share, off = found
    times.append(off / share)
    rows.append([f"`{scene.stem}`", f"{100 * share:.2g} %", f"{100 * off:.2g} %", f"{off / share:.2g}"])
recorded.record("third-order", "scripts/third_order.py", [["scene", "at an instant", "over the run", "times as much"], *rows],
                f"In `quadratic` against `exact`, of the range of deflections. In the median {statistics.median(times):.2g} times as much; "
                f"{sum(t > 10 for t in times)} of {len(times)} more than ten times.")
