"""doors_bench.py [BENCH]: one evaluation of the arm from Python, beside what the program bench-doors prints."""

import pathlib
import subprocess
import sys
import time

import numpy

import withy

equations = withy.load(pathlib.Path(__file__).parents[2] / "scenes" / "two-link-slew.yaml").compile()
y = equations.y0 + 0.01 * numpy.arange(1, len(equations.y0) + 1)
best = float("inf")
for _ in range(400):
    began = time.perf_counter()
    for _ in range(500):
        equations.derivatives(0.5, y)
    best = min(best, (time.perf_counter() - began) / 500)
print(f"Python {1e9 * best:.1f} ns", flush=True)
if len(sys.argv) > 1:
    text = subprocess.run(sys.argv[1], check=True, capture_output=True, text=True).stdout
    native = float(text.split()[1])
    print(text, end="")
    print(f"Python adds {1e9 * best - native:.0f} ns to the engine's")
