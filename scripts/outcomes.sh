#!/usr/bin/env bash
# outcomes.sh [BUILD]: runs the slew of Padilla and von Flotow in their three formulations and three speeds, and in those
# that came after, for docs/ill-conditioning.md. BUILD: build/release, else the folder given.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
build=${1:-build/release}
python3 - "$build/bin/withy" <<'PYTHON' | record_table slew-outcomes "scripts/outcomes.sh" "\`scenes/two-link-slew.yaml\` with \`loads.slew.time_scale\`; the targets are 60° and 0°. The first three formulations are those of the paper, whose nine outcomes these are: every completion and every stop. The angles of stops are those of the last state that can be trusted."
import json, math, re, subprocess, sys, tempfile

print("formulation", "0.1685 times as fast", "as fast as the paper's", "1.2 times as fast", sep="\t")
for formulation in ("ruthless", "inconsistent", "consistent", "quadratic", "symmetric", "symmetric-linear", "exact"):
    row = [f"`{formulation}`"]
    for scale in ("0.1685", "1", "1.2"):
        with tempfile.TemporaryDirectory() as folder:
            run = json.loads(subprocess.run(
                [sys.argv[1], "run", "scenes/two-link-slew.yaml", "--formulation", formulation, "--set",
                 f"loads.slew.time_scale={scale}", "--estimate", "never", "--out", folder, "--force", "--json"],
                capture_output=True, text=True).stdout)
        angles = ", ".join(f"{math.degrees(run['final']['hinges'][h]['position'][0]):.4f}°" for h in ("shoulder", "elbow"))
        if run["status"] == "completed":
            row.append(angles)
            continue
        causes = re.findall(r"The mass matrix of this formulation became singular", run["message"])
        row.append(f"**{run['status']}** at {run['t_end']:.4f} s ({angles}): "
                   + ("the mass matrix became singular" if causes else run["message"]))
    print(*row, sep="\t")
PYTHON
scripts/docs.sh
