#!/usr/bin/env python3
"""import_tables.py [PROGRAM]: measures the tables of docs/import.md into docs/measured: a cantilever of C3D20R bricks, whose matrices
CalculiX makes (Debian: calculix-ccx), imported and held against closed forms and published figures. A minute of CPU time."""
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

from recorded import Program, record

length, width, height, young, density = 1.0, 0.02, 0.01, 2.1e11, 7850.0
work = pathlib.Path(tempfile.mkdtemp())
withy = Program(sys.argv[1:])


def deck(name, counts, poisson):
    """Writes NAME.inp, a bar of counts[0] by counts[1] by counts[2] bricks, and lets CalculiX make its matrices."""
    numbers = {}
    for i in range(2 * counts[0] + 1):
        for j in range(2 * counts[1] + 1):
            for k in range(2 * counts[2] + 1):
                if i % 2 + j % 2 + k % 2 <= 1:
                    numbers[i, j, k] = len(numbers) + 1
    lines = ["*NODE, NSET=ALL"]
    for (i, j, k), n in numbers.items():
        at = (length * i / (2 * counts[0]), width * (j / (2 * counts[1]) - 0.5), height * (k / (2 * counts[2]) - 0.5))
        lines.append(f"{n}, " + ", ".join(f"{x:.12g}" for x in at))
    lines.append("*ELEMENT, TYPE=C3D20R, ELSET=PART")
    round_face = [(0, 0), (2, 0), (2, 2), (0, 2)]
    mid_sides = [(1, 0), (2, 1), (1, 2), (0, 1)]
    places = [(*c, k) for k in (0, 2) for c in round_face] + [(*c, k) for k in (0, 2) for c in mid_sides] + [(*c, 1) for c in round_face]
    element = 0
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                element += 1
                nodes = [numbers[2 * i + a, 2 * j + b, 2 * k + c] for a, b, c in places]
                lines += [f"{element}, " + ", ".join(map(str, nodes[:15])) + ",", ", ".join(map(str, nodes[15:]))]
    for name_of_set, end in (("ROOT", 0), ("TIP", 2 * counts[0])):
        lines += [f"*NSET, NSET={name_of_set}"] + [f"{n}," for at, n in numbers.items() if at[0] == end]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}", "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL",
              "*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP"]
    (work / f"{name}.inp").write_text("\n".join(lines) + "\n")
    subprocess.run(["ccx", name], cwd=work, check=True, stdout=subprocess.DEVNULL)
    return work / name


def imported(job, modes):
    """The file of the reduced body."""
    out = job.with_suffix(".SID_FEM")
    withy.run("import", job, "--root", "ROOT", "--interface", "TIP", "--modes", modes, "--out", out, "--force")
    return out


def at_rest():
    def beam(k, side):
        eigenvalue = (1.87510406871196, 4.69409113297418, 7.85475743823761)[k]
        return eigenvalue**2 * math.sqrt(young * side**2 / (12 * density)) / length**2 / (2 * math.pi)

    scene = work / "rest.yaml"
    scene.write_text(f"format: withy/1\nname: rest\ntime: {{end: 1, output: 1}}\nbodies:\n  boom: {{type: modal, file: {imported(deck('at-rest', (24, 2, 2), 0.3), 6)}}}\n"
                     "hinges:\n  root: {type: weld, parent: world, child: boom}\n")
    found = [f / (2 * math.pi) for f in withy.frequencies(scene)]
    cases = [("first, out of the flat side", 0, height), ("first, edgewise", 0, width), ("second, out of the flat side", 1, height),
             ("second, edgewise", 1, width), ("third, out of the flat side", 2, height)]
    rows = [["bending", "beam [Hz]", "imported [Hz]", "apart"]]
    for name, k, side in cases:
        f = beam(k, side)
        nearest = min(found, key=lambda x: abs(x / f - 1))
        rows.append([name, f"{f:.6g}", f"{nearest:.6g}", f"{100 * abs(nearest / f - 1):.2f} %"])
    record("import-at-rest", "scripts/import_tables.py", rows)


def spinning():
    # Wright, Smith, Thresher & Wang, J. Appl. Mech. 49, 1982: flap of a uniform beam without hub.
    published = {0: (3.5160, 22.0345), 1: (3.6817, 22.1810), 2: (4.1373, 22.6149), 4: (5.5850, 24.2734), 6: (7.3604, 26.8091), 12: (13.1702, 37.6031)}
    scale = math.sqrt(density * width * height * length**4 / (young * width * height**3 / 12))
    scene = work / "spinning.yaml"
    scene.write_text(f"format: withy/1\nname: spinning\nformulation: consistent\ntime: {{end: 1, output: 1}}\nbodies:\n  boom: {{type: modal, file: {imported(deck('full', (24, 4, 2), 0.3), 6)}}}\n"
                     "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}\n")
    found = {}
    for rate, of_others in published.items():
        all_of_them = [scale * f for f in withy.frequencies(scene, "--lock", "axle", *(["--spin", f"axle={rate / scale!r}"] if rate else []))]
        found[rate] = [min(all_of_them, key=lambda x: abs(x - f)) for f in of_others]
    rows = [["Ω", *published]]
    for k, name in enumerate(("first", "second")):
        rows.append([f"{name}, published", *(f"{f[k]:.4f}" for f in published.values())])
        rows.append([f"{name}, imported", *(f"{f[k]:.4f}" for f in found.values())])
    record("import-spinning", "scripts/import_tables.py", rows)


if not shutil.which("ccx"):
    sys.exit("import_tables.py needs CalculiX: apt install calculix-ccx")
at_rest()
spinning()
subprocess.run(["scripts/docs.sh"], cwd=pathlib.Path(__file__).resolve().parents[1], check=False)
