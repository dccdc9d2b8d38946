"""doors_bench.py [BENCH [WITHY]]: one evaluation of the arm from Python, by turns with the program bench-doors, of
whose runs the fastest is printed; then a run of it from Python beside one of the command line, by turns."""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy

import withy

file = pathlib.Path(__file__).parents[2] / "scenes" / "two-link-slew.yaml"
equations = withy.load(file).compile()
y = equations.y0 + 0.01 * numpy.arange(1, len(equations.y0) + 1)
best, told = float("inf"), []
for _ in range(5):
    for _ in range(80):
        began = time.perf_counter()
        for _ in range(500):
            equations.derivatives(0.5, y)
        best = min(best, (time.perf_counter() - began) / 500)
    if len(sys.argv) > 1:
        told.append(subprocess.run(sys.argv[1], check=True, capture_output=True, text=True).stdout)
print(f"Python {1e9 * best:.1f} ns", flush=True)
if told:
    text = min(told, key=lambda one: float(one.split()[1]))
    native = float(text.split()[1])
    print(text, end="")
    print(f"Python adds {1e9 * best - native:.0f} ns to the engine's (limit 600)")
    print("limits: C 1.05, FMU 1.3")
if len(sys.argv) > 2:
    scene = withy.load(file)
    here, there, own_here, own_there = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(15):
            began = time.process_time()
            result = scene.run()
            here.append(time.process_time() - began)
            own_here.append(result.summary["cpu_seconds"])
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.argv[2], "run", file, "--out", folder, "--force"], check=True, capture_output=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            there.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            own_there.append(json.loads((pathlib.Path(folder) / "run.json").read_text())["cpu_seconds"])
    print(f"scene.run() {1e3 * min(here):.1f} ms CPU, {min(here) / min(there):.3f} of the process withy run; the run itself "
          f"{1e3 * min(own_here):.2f} ms, {min(own_here) / min(own_there):.3f} of the command's (limit 1.02)")
