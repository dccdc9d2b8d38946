#!/usr/bin/env python3
"""tables.py [PROGRAM]: measures the small tables of the pages that are no trades and no times, into docs/measured, and puts
them into the pages: ends of slews (loads), what shapers leave (motions), convergence of mode families, a round trip of inverse dynamics (modes), arms
in segments (bodies), the reference turbine (models). Two minutes of CPU time."""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy

import recorded

top = pathlib.Path(__file__).resolve().parents[1]
program = recorded.Program(sys.argv[1:])
work = pathlib.Path(tempfile.mkdtemp())


withy, told, frequencies = program.run, program.told, program.frequencies


def record(name, rows, sentence=""):
    recorded.record(name, "scripts/tables.py", rows, sentence)


def share(x):
    """An error as per cent, or as a power of ten where it is small; below rounding it is none."""
    if x < 3e-14:
        return "exact"
    return f"{100 * x:.0f} %" if x >= 0.1 else f"{100 * x:.2g} %" if x >= 1e-3 else f"{x:.1e}"


def slews():
    names = ["ruthless", "inconsistent", "consistent", "quadratic", "exact"]
    def cell(run):
        if run["status"] != "completed":
            return f'{run["status"]}, {run["t_end"]:.2g} s'
        return ", ".join(f'{math.degrees(run["final"]["hinges"][h]["position"][0]):.4f}' for h in ("shoulder", "elbow"))

    rows = [["`time_scale`", *names]]
    for scale in (0.1685, 1.0, 1.2):
        rows.append([scale, *(cell(told("run", "scenes/extended-slew.yaml", "--formulation", n, "--set", f"loads.slew.time_scale={scale}", "--set",
                                        "integrator.rtol=1e-7", "--out", work / "slew", "--force")) for n in names)])
    record("extended-slew-ends", rows)


def cantilevers():
    beam = "beam: {{type: beam, length: 1, mass_per_length: 1, bending_y: {{stiffness: 1, modes: {n}, family: {family}}}}}"
    load = ("  load: {type: rigid, mass: 5, center_of_mass: [0.2, 0, 0], inertia: [0.8, 0.8, 0.8, 0, 0, 0]}\n",
            "  mount: {type: weld, parent: beam.tip, child: load}\n")
    load_there = "tip_mass: 5, tip_inertia: 0.8, tip_offset: 0.2}"
    loaded, vibration = "{name: clamped-loaded, " + load_there, "{name: vibration-modes, " + load_there

    def first(family, n, carries):
        scene = work / "cantilever.yaml"
        scene.write_text("format: withy/1\nname: cantilever\ntime: {end: 1, output: 1}\nbodies:\n  " + beam.format(n=n, family=family) + "\n" +
                         (load[0] if carries else "") + "hinges:\n  root: {type: weld, parent: world, child: beam}\n" + (load[1] if carries else ""))
        return frequencies(scene)[0]

    exact = {False: first("clamped-free", 1, False), True: first(loaded, 1, True)}
    names = {loaded: "`clamped-loaded`, that load", vibration: "`vibration-modes`, that load"}
    rows = [["family", "bare, n = 1", "3", "10", "loaded, n = 1", "3", "10"]]
    for family in ("clamped-free", loaded, vibration, "craig-bampton", "orthogonal-polynomials", "pinned-free", "free-free"):
        cells = []
        for carries in (False, True):
            for n in (1, 3, 10):
                cells.append("" if family in names and not carries else share(abs(first(family, n, carries) / exact[carries] - 1)))
        rows.append([names.get(family, f"`{family}`"), *cells])
    record("families-cantilever", rows)


def blade_families():
    """The gallery's blade, flapwise, its root held: frequencies, and how far a force at the tip deflects it."""
    scene = "scenes/gallery/wind-turbine-blade.yaml"
    families = {"`clamped-free`": "clamped-free", "`orthogonal-polynomials`": "orthogonal-polynomials", "`craig-bampton`": "craig-bampton",
                "`vibration-modes`": "vibration-modes", "`vibration-modes`, `static: 0`": "{name: vibration-modes, static: 0}"}

    def settings(family, n):
        return [w for s in ("motions={}", "gravity=[0, 0, 0]", "hinges.shaft={type: weld, parent: world, child: hub}", f"bodies.blade.bending_z.modes={n}",
                            f"bodies.blade.bending_z.family={family}", "bodies.blade.bending_y.modes=0", "bodies.blade.frames={}",
                            "loads={pull: {type: force, frame: blade.tip, value: [0, 0, 100]}}") for w in ("--set", s)]

    def found(family, n):
        at = told("equilibrium", scene, *settings(family, n))
        deflection = at["tip_deflections"]["blade.tip"][2]
        return frequencies(scene, *settings(family, n)), deflection

    exact, tip = found("{name: vibration-modes, static: 2}", 16)
    rows = [["family", "n", "1st", "2nd", "3rd", "tip under a force", "fastest [Hz]"]]
    for name, family in families.items():
        for n in (1, 2, 3, 4, 8):
            f, deflected = found(family, n)
            rows.append([name, n, *(share(abs(f[i] / exact[i] - 1)) if i < n else "" for i in range(3)), share(abs(deflected / tip - 1)), f"{max(f) / (2 * math.pi):.1f}"])
    record("families-blade", rows, "Flapwise, the root held: errors of the first three frequencies, " + ", ".join(f"{x / (2 * math.pi):.4f}" for x in exact[:3]) +
           " Hz, and of the static deflection under a force at the tip, against 16 functions; and the fastest of the n modes.")


def arm_families():
    straight = work / "straight.json"
    straight.write_text('{"hinges": {"elbow": {"position": [0]}}}')

    def loaded(mass, inertia, offset):
        return f"{{name: clamped-loaded, tip_mass: {mass}, tip_inertia: {inertia}, tip_offset: {offset}}}"

    def settings(n, first, second):
        return [w for s in (f"bodies.link1.bending_y={{stiffness: 112.106, modes: {n}, family: {first}}}",
                            f"bodies.link2.bending_y={{stiffness: 14.0133, modes: {n}, family: {second}}}", "loads={}", "time={end: 1, output: 1}")
                for w in ("--set", s)]

    def locked(*model):
        return frequencies("scenes/two-link-slew.yaml", "--at", straight, "--lock", "shoulder,elbow", "--count", 30, *settings(*model))

    payload = loaded(2, 0.01, 0.0508)
    families = {"`clamped-free`": ("clamped-free", "clamped-free"), "`clamped-loaded`, body welded": (loaded(14, 0.03, 0.0762), payload),
                "all outboard": (loaded(16.61, 2.128, 0.2232), payload)}
    exact = locked(9, "orthogonal-polynomials", "orthogonal-polynomials")[:4]
    rows = [["n", *(head for name in families for head in (f"{name}: κ(M)", "1st", "2nd", "3rd", "4th"))]]
    for n in range(1, 7):
        cells = []
        for pair in families.values():
            state = told("eval", "scenes/two-link-slew.yaml", "--state", straight, *settings(n, *pair))
            cells.append(f'{state["condition"]:.1e}')
            found = locked(n, *pair)
            cells += [f"{abs(found[i] / exact[i] - 1):.1e}" if i < len(found) else "" for i in range(4)]
        rows.append([n, *cells])
    record("families-arm", rows, "The first four frequencies: " + ", ".join(f"{f:.6g}" for f in exact) + " rad/s.")


def segments():
    def tip(pieces, modes, formulation, integrator, rtol):
        family = "orthogonal-polynomials"
        settings = [f"bodies.link1.segments={pieces}", f"bodies.link2.segments={pieces}",
                    f"bodies.link1.bending_y={{stiffness: 112, modes: {modes}, family: {family}}}",
                    f"bodies.link2.bending_y={{stiffness: 14, modes: {modes}, family: {family}}}",
                    f"integrator={{name: {integrator}, rtol: {rtol}, atol: {rtol}}}"]
        withy("run", "scenes/driven-arm.yaml", "--formulation", formulation, *(w for s in settings for w in ("--set", s)), "--out", work / "tip", "--force",
              status=(0,))
        last = list(csv.DictReader(open(work / "tip" / "results.csv")))[-1]
        return [float(last[f"payload.tip.{c}[m]"]) for c in "xy"]

    cases = [("one rod with 6 polynomials, `exact`, rtol 1e-9", (1, 6, "exact", "dopri5", 1e-9)),
             ("4 segments of 2 polynomials, `quadratic`, rtol 1e-9", (4, 2, "quadratic", "dopri5", 1e-9)),
             ("32 segments of 1 polynomial, `linear`, `rosenbrock-w`, rtol 1e-7", (32, 1, "linear", "rosenbrock-w", 1e-7))]
    rows, exact = [["links", "tip x, y [m]", "away from `exact`"]], None
    for name, case in cases:
        at = tip(*case)
        exact = exact or at
        off = math.dist(at, exact)
        rows.append([name, f"{at[0]:.6f}, {at[1]:.6f}", f"{1e6 * off:.2g} µm" if off else ""])
    record("arm-in-segments", rows)


def round_trip():
    rows = [["rows every", "1 mode: shoulder, elbow", "tip", "2 modes: shoulder, elbow", "tip"]]
    for step in ("4 ms", "2 ms", "1 ms"):
        cells = []
        for modes in (1, 2):
            settings = [w for s in ("time.end=1", f"time.output={step}", f"bodies.link1.bending_y.modes={modes}", f"bodies.link2.bending_y.modes={modes}",
                                    "integrator.rtol=1e-9", "integrator.atol=1e-11") for w in ("--set", s)]
            there, back = work / "there", work / "back"
            withy("run", "scenes/driven-arm.yaml", *settings, "--out", there, "--force")
            withy("inverse", "scenes/driven-arm.yaml", *settings, "--motion", there / "results.csv", "--set", "loads={}", "--out", back, "--force")
            a, b = ({k.split("[")[0]: numpy.array(v, float) for k, *v in zip(*csv.reader(open(f / "results.csv")))} for f in (there, back))
            torque = {"shoulder": 20 * numpy.sin(2 * math.pi * a["t"] / 5), "elbow": -4 * numpy.sin(2 * math.pi * a["t"] / 2.5)}
            off = [numpy.abs(b[f"{h}.motion_effort"] - torque[h]).max() for h in ("shoulder", "elbow")]
            tip = numpy.sqrt(sum((a[f"payload.tip.{c}"] - b[f"payload.tip.{c}"]) ** 2 for c in "xyz")).max()
            cells += [", ".join(f"{x:.2g}" for x in off), f"{1000 * tip:.2g} mm"]
        rows.append([step, *cells])
    record("inverse-round-trip", rows)


def turbine():
    withy("import", "scenes/models/blade.dat", "--length", 61.5, "--out", work / "blade.yaml")
    withy("import", "scenes/models/tower.dat", "--length", 87.6, "--tip-mass", "350e3", "--out", work / "tower.yaml")
    hertz = [f / (2 * math.pi) for f in frequencies(work / "blade.yaml")[:2]] + [frequencies(work / "tower.yaml")[0] / (2 * math.pi)]
    heads = [("blade, first flapwise", "0.68–0.70"), ("blade, first edgewise", "1.08"), ("tower with 350 t, first, both ways", "0.32–0.34")]
    record("turbine-frequencies", [["", "imported [Hz]", "published [Hz]"]] + [[n, f"{f:.3f}", p] for (n, p), f in zip(heads, hertz)])


def shapers():
    withy("sweep", "run", "scenes/sweeps/shapers.yaml", "--out", work / "shapers")
    withy("sweep", "collect", work / "shapers")
    left, masses, names = {}, [], []
    for row in csv.DictReader(open(work / "shapers" / "table.csv")):
        name, mass = row["motions.slew.shaper"], float(row["bodies.payload.mass"])
        left[name, mass] = 1000 * float(row["final.left.max[m]"])
        masses += [] if mass in masses else [mass]
        names += [] if name in names else [name]
    record("shapers", [["payload", *(f"`{n}`" for n in names)]] + [[f"{m:g} kg", *(f"{float(f'{left[n, m]:.2g}'):g} mm" for n in names)] for m in masses])


slews()
shapers()
cantilevers()
blade_families()
arm_families()
segments()
round_trip()
turbine()
subprocess.run(["scripts/docs.sh"], cwd=top, check=False)
