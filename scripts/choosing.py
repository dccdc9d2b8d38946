#!/usr/bin/env python3
"""choosing.py [--check]: the tables of the gallery (docs/measured/trade-*.txt) as one, docs/measured/choosing.txt: of each
scene the tip errors and costs of the formulations, and the cheapest model within 5 % and 1 %. It measures nothing:
scripts/gallery.sh does. With --check nothing is written, and a table that says something else is an error."""
import pathlib
import sys

measured = pathlib.Path(__file__).resolve().parents[1] / "docs/measured"
formulations = ["ruthless", "linear", "consistent", "symmetric", "quadratic", "exact"]


def read(file):
    """What the head of a file of measurements says, and its rows as dictionaries."""
    head, table = file.read_text().split("\n\n")[:2]
    names, *rows = [line.split("\t") for line in table.splitlines()]
    return dict(line.split(": ", 1) for line in head.splitlines()), [dict(zip(names, row)) for row in rows]


def two_digits(x):
    return f"{float(f'{x:.2g}'):g}"


def completed(row):
    return row["steps"] != ""


def cell(rows, formulation, unit):
    """Tip error with the most modes, and its cost as a share of what `unit` costs; or how it ends."""
    mine = [r for r in rows if r["formulation"].strip("*") == formulation and r["integrator"] == "dopri5"]
    if not mine:
        return ""
    last = mine[-1]
    if not completed(last):
        return last["hinge error"]
    return f'{two_digits(float(last["tip error [mm]"]))} mm · {two_digits(float(last["CPU [ms]"]) / unit)}'


def cheapest(rows, percent):
    good = [r for r in rows if completed(r) and float(r["error [%]"]) <= percent]
    if not good:
        return "none tried"
    best = min(good, key=lambda r: float(r["CPU [ms]"]))
    modes = best["modes"].replace("orthogonal-polynomials", "polynomials").replace(" clamped-free", "")
    return f'{best["formulation"].strip("*")}, {modes}'


heads, lines = [], ["scene\t" + "\t".join(formulations) + "\twithin 5 %\twithin 1 %"]
for file in sorted(measured.glob("trade-*.txt")):
    head, rows = read(file)
    heads.append(head)
    for over in dict.fromkeys(r.get("over", "") for r in rows):
        here = [r for r in rows if r.get("over", "") == over]
        # Another family has rows of its own; those of the one that comes last are as good or better.
        unit = float([r for r in here if r["formulation"].strip("*") == "quadratic" and r["integrator"] == "dopri5"][-1]["CPU [ms]"])
        name = file.stem.removeprefix("trade-").replace("-", " ") + (f", {over}" if over else "")
        lines.append("\t".join([name, *(cell(here, f, unit) for f in formulations), cheapest(here, 5), cheapest(here, 1)]))

text = (f'command: scripts/choosing.py, from what scripts/gallery.sh has measured\n'
        f'commit: {", ".join(sorted({h["commit"] for h in heads}))}\ndate: {max(h["date"] for h in heads)}\n\n' + "\n".join(lines) + "\n")
target = measured / "choosing.txt"
if sys.argv[1:] == ["--check"]:
    if not target.exists() or target.read_text() != text:
        sys.exit(f"{target.name} does not say what the tables of the gallery say: run scripts/docs.sh")
elif sys.argv[1:]:
    sys.exit("usage: scripts/choosing.py [--check]")
else:
    target.write_text(text)
