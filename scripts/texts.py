#!/usr/bin/env python3
"""texts.py [PROGRAM [NAME…]]: measures what running text of the pages says in numbers, into docs/measured, and puts it into the
pages; with names these files alone. Memory and times are of the machine that it runs on. Three minutes of CPU time."""
import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import recorded

program = recorded.Program(sys.argv[1:2])
work = pathlib.Path(tempfile.mkdtemp())


def record(name, rows, sentence="", machine=False):
    recorded.record(name, "scripts/texts.py", rows, sentence, machine)


def digits(x, n=2):
    return f"{float(f'{x:.{n}g}'):g}"


def cost(*words):
    """CPU time [s] and greatest memory [MB] of a command."""
    child = subprocess.Popen([program.path, *map(str, words)], cwd=recorded.top, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in (0, 1):
        sys.exit(f"withy {' '.join(map(str, words))} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024 / 1e6


def advice():
    told = program.run("advise", "scenes/spin-up.yaml", "--accuracy", "1%").split("\nin the scene:")[0].strip()
    record("advice-spin-up", [], f"```\n{told}\n```", machine=True)


def pictures():
    def tips(scene, tip, formulations, *settings):
        words = [w for s in settings for w in ("--set", s)]
        program.run("compare", scene, "--formulations", ",".join(formulations), "--reference", "exact", *words, "--out", work / "compare", "--force")
        places = {}
        for f in (*formulations, "exact"):
            rows = list(csv.DictReader(open(work / "compare" / f / "results.csv")))
            places[f] = [[float(r[f"{tip}.{c}[m]"]) for c in "xyz"] for r in rows]
        exact = places.pop("exact")
        return {f: 1000 * max(map(math.dist, p, exact)) for f, p in places.items()}

    slew = tips("scenes/two-link-slew.yaml", "payload.tip", ["ruthless", "quadratic"], "loads.slew.time_scale=1.2", "time.output=0.01")
    swing = tips("scenes/gallery/flexible-pendulum.yaml", "strip.tip", ["ruthless", "quadratic"], "time.output=0.02", "time.end=4")
    rows = [["picture", "`ruthless`, tip off by [mm]", "`quadratic`, tip off by [mm]"]]
    for name, off in (("slew, 1.2 times as fast", slew), ("strip on a pin, 4 s", swing)):
        rows.append([name, digits(off["ruthless"], 3), digits(off["quadratic"])])
    record("readme-pictures", rows)


def mounted_damping():
    locked = ["modes", "scenes/two-link-slew.yaml", "--lock", "shoulder,elbow"]
    ratios = [m["damping_ratio"] for m in program.told(*locked)["runs"][0]["points"][0]["modes"]]
    reached = [m["reached"] for m in program.told(*locked, "--damp", "1%,1%,1%")["damping"]["modes"]]
    def per_cent(values):
        return ", ".join(f"{100 * v:.2f}" for v in values) + " %"
    record("mounted-damping", [], "The two-link arm of `scenes/two-link-slew.yaml`, 1 % asked of its links, has with its hinges locked "
           f"({' '.join(['`withy', *locked]).replace('shoulder,elbow', 'shoulder,elbow`')}) {per_cent(ratios)}.")
    record("damping-found", [], "Bodies damped each by itself cannot give a tree any ratios one likes: the arm's two lowest modes strain both links alike, "
           f"in phase and against each other, so that 1 % asked of three modes (`--damp 1%,1%,1%`) becomes {per_cent(reached)}.")


def boom_families():
    """How far the left boom's deflection is from that with many polynomials, over 5 s."""
    def deflection(count, bending, torsion):
        settings = ["time.end=5", "integrator={name: imex, rtol: 1e-7, atol: 1e-9}", "initial.bodies={}"]
        for boom in ("left_boom", "right_boom"):
            for strain, family in (("bending_y", bending), ("bending_z", bending), ("torsion", torsion)):
                settings += [f"bodies.{boom}.{strain}.modes={count}", f"bodies.{boom}.{strain}.family={family}"]
        program.run("run", "scenes/spacecraft.yaml", *(w for s in settings for w in ("--set", s)), "--out", work / "boom", "--force", status=(0,))
        rows = list(csv.DictReader(open(work / "boom" / "results.csv")))
        return [[1000 * float(r[f"left_boom.tip.deflection_{c}[m]"]) for c in "xyz"] for r in rows]

    free, polynomials = "clamped-free", "orthogonal-polynomials"
    truth = deflection(8, polynomials, polynomials)
    reach = max(math.dist(place, truth[0]) for place in truth)
    rows = [["bending", "twist", "modes each", "deflection off by [mm]"]]
    for count, bending, torsion in ((6, free, free), (7, free, free), (5, polynomials, free), (5, polynomials, polynomials)):
        off = max(map(math.dist, deflection(count, bending, torsion), truth))
        rows.append([f"`{bending}`", f"`{torsion}`", count, digits(off)])
    record("boom-families", rows, f"`scenes/spacecraft.yaml`, 5 s from straight booms: the left boom's tip, which is deflected by {digits(reach)} mm, against eight polynomials of each.")


def chain_memory():
    def chain(links, body):
        axes = ["[0, 1, 0]", "[0, 0, 1]", "[0.6, 0.8, 0]", "[0, 0.6, 0.8]", "[0.8, 0, 0.6]"]
        bodies = "".join(f"  l{i}: {body}\n" for i in range(links))
        hinges = "".join(f"  h{i}: {{type: revolute, axis: {axes[i % 5]}, parent: {'world' if i == 0 else f'l{i - 1}.tip'}, child: l{i}}}\n" for i in range(links))
        path = work / "chain.yaml"
        path.write_text("format: withy/1\nname: chain\ngravity: [0, -9.81, 0]\nformulation: quadratic\nintegrator: {name: rk4, step: 0.0001}\n"
                        f"time: {{end: 0.01, output: 0.001}}\nbodies:\n{bodies}hinges:\n{hinges}")
        return cost("run", path, "--out", work / "chain", "--force")

    def bending(n):
        return f"bending_y: {{stiffness: 100, modes: {n}}}, bending_z: {{stiffness: 100, modes: {n}}}"

    kinds = [("`quadratic` beams, 2+2 modes", "{type: beam, length: 1, mass_per_length: 1, %s}" % bending(2)),
             ("`quadratic` beams, 1+1 modes", "{type: beam, length: 1, mass_per_length: 1, %s}" % bending(1)),
             ("rigid", "{type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}")]
    rows = [["2,000 links, 100 steps of `rk4`", "CPU [s]", "memory [MB]", "a link beyond ten [kB]"]]
    for name, body in kinds:
        (_, little), (seconds, much) = chain(10, body), chain(2000, body)
        rows.append([name, digits(seconds), f"{much:.0f}", f"{1000 * (much - little) / 1990:.0f}"])
    record("chain-memory", rows, "`withy run` as a process, the equal links of the chain above.", machine=True)


def sweep_cost():
    def sweep(cases):
        plan = work / "sweep.yaml"
        plan.write_text(f"format: withy-sweep/1\nname: cost\nscene: {recorded.top}/scenes/driven-arm.yaml\nset: {{integrator: {{name: rk4, step: 0.002}}}}\n"
                        f"vary: {{bodies.payload.mass: {{normal: {{mean: 2, deviation: 0.05}}}}}}\ncases: {cases}\nseed: 5\n"
                        "keep: {final: [shoulder, elbow, link2.tip], peak: [link2.tip.deflection_y]}\n")
        store = work / f"sweep-{cases}"
        run = cost("sweep", "run", plan, "--out", store, "--jobs", 1)
        size = sum(f.stat().st_size for f in store.rglob("*") if f.suffix not in (".csv", ".html", ".svg", ".json", ".yaml"))
        table = (store / "table.csv").stat().st_size
        return run, cost("sweep", "collect", store), size, table

    few, many = sweep(100), sweep(2000)
    each = (many[0][0] - few[0][0]) / 1900
    rows = [["10 s of the driven arm, `quadratic`, `rk4` with 2 ms", "", ""],
            ["`withy sweep run`, a case", f"{1000 * each:.1f} ms", f"{many[0][1]:.0f} MB at most with 2,000 cases"],
            ["its record in the store", f"{(many[2] - few[2]) / 1900:.0f} bytes", ""],
            ["`withy sweep collect` of 2,000", f"{many[1][0]:.2g} s", f"{many[1][1]:.0f} MB at most"]]
    record("sweep-cost", rows, "", machine=True)


def tree_estimates():
    test = pathlib.Path(program.path).with_name("test-validity")
    done = subprocess.run([recorded.top / test, "--gtest_filter=*factor_of_three"], cwd=recorded.top, capture_output=True, text=True, env={**os.environ, "WITHY_TEST_SEEDS": "60"})
    found = re.search(r"within a factor of three: (\d+ of \d+), worst factor ([\d.]+)", done.stdout)
    if done.returncode or not found:
        sys.exit(done.stdout + done.stderr)
    record("estimate-trees", [], f"Random trees of four bodies, planar and in space, 0.5 s, `ruthless` and `linear`, truth by two separate runs at 1e-7; scenes in which the formulations differ by less "
           f"than 1e-5 are left out: the claim was within a factor of three in {found[1]}, the worst factor was {found[2]}.")


def figures():
    """Frequencies and deflections that running text of gallery.md and integrators.md compares with."""
    def frequencies(scene, *words):
        modes = program.told("modes", scene, *words)["runs"][0]["points"][0]["modes"]
        return [abs(m["eigenvalue"][1]) for m in modes]

    blade = "scenes/gallery/wind-turbine-blade.yaml"
    six = ["--set", "bodies.blade.bending_y.modes=6", "--set", "bodies.blade.bending_z.modes=6"]
    def most_deflected(formulation):
        program.run("run", blade, "--formulation", formulation, *six, "--out", work / "blade", "--force")
        rows = list(csv.DictReader(open(work / "blade" / "results.csv")))
        return max(abs(float(r["blade.tip.deflection_z[m]"])) for r in rows)

    hertz = [f / math.tau for f in frequencies(blade, "--as-is", *six, "--set", "gravity=[0, 0, 0]", "--set", "motions.turn.rate=0", "--set", "loads={}")]
    spinning = "scenes/gallery/spinning-beam.yaml"
    frozen, full = (frequencies(spinning, "--formulations", f) for f in ("ruthless", "quadratic"))
    record("figures", [
        ["what", "how much"],
        *([f"blade of the wind turbine, six functions, mode {i + 1}", f"{hertz[i]:.3f} Hz"] for i in range(3)),
        *([f"its tip out of the plane at most, `{f}`", f"{most_deflected(f):.2f} m"] for f in ("linear", "quadratic")),
        ["spinning beam, `ruthless`", f"{frozen[0]:.2f} rad/s"],
        *([f"spinning beam, `quadratic`, mode {i + 1}", f"{full[i]:.2f} rad/s"] for i in range(2)),
        ["long chain", f"{frequencies('scenes/gallery/long-chain.yaml', '--as-is')[0]:.1f} rad/s"],
        ["blade of `spin-up`, greatest", f"{max(frequencies('scenes/spin-up.yaml', '--as-is')):.0f} rad/s"]])


everything = {f.__name__: f for f in (advice, pictures, mounted_damping, boom_families, chain_memory, sweep_cost, tree_estimates, figures)}
if unknown := [n for n in sys.argv[2:] if n not in everything]:
    sys.exit(f"texts.py knows {', '.join(everything)}, not {', '.join(unknown)}")
for measure_it in [everything[n] for n in sys.argv[2:]] or everything.values():
    measure_it()
subprocess.run(["scripts/docs.sh"], cwd=recorded.top, check=False)
