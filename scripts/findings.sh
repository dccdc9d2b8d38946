#!/usr/bin/env bash
# findings.sh [BUILD]: measures when `withy advise` tells what on a terminal, for docs/advise.md. BUILD: build/release,
# else the folder given.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
build=${1:-build/release}
python3 - "$build/bin/withy" <<'PYTHON' | record_table findings "scripts/findings.sh" "Seconds on the clock from the beginning of \`withy advise --accuracy 1%\` until a line of its kind stood on the terminal, the reading of the scene included; one search each. CPU time: of the search. None: no model held the accuracy in the time allowed, and the answer says so."
import json, os, pty, re, subprocess, sys, time

def search(scene):
    """Seconds until the first line of each kind, until the answer, and of CPU time."""
    ours, terminal = pty.openpty()
    began = time.monotonic()
    program = subprocess.Popen([sys.argv[1], "advise", scene, "--accuracy", "1%", "--json"], stdout=subprocess.PIPE,
                               stderr=terminal, stdin=subprocess.DEVNULL)
    os.close(terminal)
    os.set_blocking(ours, False)
    first, told, shown, output = {}, "", 0, b""
    os.set_blocking(program.stdout.fileno(), False)
    while True:
        over = program.poll() is not None
        try:
            told += os.read(ours, 65536).decode()
        except (BlockingIOError, OSError):
            pass
        output += program.stdout.read() or b""
        for kind, words in (("cost", "the search takes"), ("reference", "reference so far"),
                            ("failing", "does not hold"), ("holding", " so far: ")):
            if words in re.sub(r"\s+", " ", told.replace("reference so far:", "reference so far;") if kind == "holding" else told):
                first.setdefault(kind, time.monotonic() - began)
        if over:
            break
        time.sleep(0.01)
    return first, time.monotonic() - began, json.loads(output)

print("scene", "what it may cost", "reference so far", "a model that does not hold", "one that holds", "answer", "CPU time", sep="\t")
scenes = ["driven-arm", "two-link-slew", "spacecraft", "solar-panel", "spin-up", "gallery/long-chain", "gallery/manipulator",
          "gallery/satellite-wheel", "gallery/spinning-plate", "gallery/wind-turbine-blade"]
for name in scenes:
    first, whole, said = search(f"scenes/{name}.yaml")
    cell = lambda kind: f"{first[kind]:.1f}" if kind in first else "none"
    print(f"`{name.split('/')[-1]}`", cell("cost"), cell("reference"), cell("failing"), cell("holding"), f"{whole:.1f}",
          f"{said.get('search', said).get('cpu_seconds', float('nan')):.1f}", sep="\t", flush=True)
PYTHON
scripts/docs.sh
