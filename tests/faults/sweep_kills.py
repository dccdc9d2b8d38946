#!/usr/bin/env python3
"""A sweep of very many cases that is killed again and again: its tables are those of the undisturbed one, byte by byte.

sweep_kills.py --program build/release/bin/withy [--cases 100000] [--kills 50] [--jobs 2] [--seed N] [--table FILE]

Status 1 where a case that was done is lost, where a table differs, or where more than 200 MB of memory were needed.
"""
import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from common import Bench  # noqa: E402

# The driven arm's whole ten seconds.
PLAN = '''format: withy-sweep/1
scene: scenes/driven-arm.yaml
set: {{integrator: {{name: rk4, step: 0.009}}}}
vary:
  bodies.payload.mass: {{normal: {{mean: 2, deviation: 0.05}}}}
  bodies.link1.bending_y.stiffness: {{normal: {{mean: 112, deviation: 3}}}}
cases: {cases}
evaluation: in-lanes
seed: 5
keep: {{final: [shoulder, elbow, link2.tip], peak: [link2.tip.deflection_y]}}
'''
TABLES = ('table.csv', 'statistics.csv', 'failed.csv')
MOST_MEGABYTES = 200


def ended(process):
    """Status, wall time of waiting and greatest memory [MB] of one process."""
    began = time.monotonic()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, time.monotonic() - began, usage.ru_maxrss / 1024


class Sweeps:
    def __init__(self, bench, jobs):
        self.bench, self.jobs, self.megabytes = bench, jobs, 0.0

    def start(self, *arguments):
        return subprocess.Popen([self.bench.program, 'sweep', *arguments], cwd=self.bench.folder,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def run_to_end(self, *arguments):
        began = time.monotonic()
        status, _, megabytes = ended(self.start(*arguments))
        self.megabytes = max(self.megabytes, megabytes)
        if status != 0:
            raise SystemExit(f'withy sweep {" ".join(arguments)}: status {status}')
        return time.monotonic() - began

    def to(self, store):
        return 'run', 'plan.yaml', '--jobs', str(self.jobs), '--out', store

    def done(self, store):
        said = self.bench.run(['sweep', 'status', store, '--json'])
        return json.loads(said.out)['done'] if said.status == 0 else 0

    def killed(self, store, after):
        """Whether the kill came before the end."""
        process = self.start(*self.to(store))
        time.sleep(after)
        os.kill(process.pid, signal.SIGKILL)  # it has not been waited for, even where it has ended
        status, _, megabytes = ended(process)
        self.megabytes = max(self.megabytes, megabytes)
        return status == -signal.SIGKILL


def megabytes_of(folder):
    return sum(f.stat().st_size for f in folder.rglob('*') if f.is_file()) / 1e6


def campaign(bench, cases, kills, jobs):
    """Rows of the table, and what was not as it should be."""
    faults = []
    sweeps = Sweeps(bench, jobs)
    bench.write('plan.yaml', PLAN.format(cases=cases))
    wall = sweeps.run_to_end(*sweeps.to('whole'))
    collect = sweeps.run_to_end('collect', 'whole')
    at_work = 0
    before = 0
    for _ in range(kills):
        # Together about as long as the whole takes, so that kills fall all along it.
        at_work += sweeps.killed('killed', bench.random.uniform(0, 2 * wall / (kills + 1)))
        now = sweeps.done('killed')
        if now < before:
            faults.append(f'{before} cases were done, {now} are left')
        before = now
    sweeps.run_to_end(*sweeps.to('killed'))
    for table in TABLES:
        if bench.read(f'killed/{table}') != bench.read(f'whole/{table}'):
            faults.append(f'{table} is not that of the undisturbed sweep')
    if sweeps.megabytes > MOST_MEGABYTES:
        faults.append(f'{sweeps.megabytes:.0f} MB of memory, more than {MOST_MEGABYTES}')
    same = 'no' if any('table' in f or '.csv' in f for f in faults) else 'yes'
    rows = [('cases', cases), (f'wall time undisturbed, {jobs} threads', f'{wall:.0f} s'),
            ('store', f'{megabytes_of(bench.folder / "whole" / "segments"):.1f} MB'),
            ('`table.csv`', f'{len(bench.read("whole/table.csv")) / 1e6:.1f} MB'),
            ('`collect`', f'{collect:.1f} s'),
            ('memory at most, of all processes', f'{sweeps.megabytes:.0f} MB'),
            ('`kill -9`, of them while it was at work', f'{kills}, {at_work}'),
            ('done when the last kill came', before),
            ('tables the same, byte by byte', same)]
    return rows, faults


def measured(rows, sources, arguments):
    commit = subprocess.run(['git', 'rev-parse', '--short', 'HEAD'], cwd=sources, capture_output=True, text=True)
    machine = next((line.split(':', 1)[1].strip() for line in open('/proc/cpuinfo') if line.startswith('model name')), '')
    lines = [f'command: ninja -C build/release sweep-kills{arguments}', f'commit: {commit.stdout.strip()}',
             f'machine: {machine}, {os.cpu_count()} cores', f'date: {time.strftime("%Y-%m-%d")}', '', '\t']
    return '\n'.join(lines + [f'{name}\t{value}' for name, value in rows]) + '\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--program', required=True)
    parser.add_argument('--cases', type=int, default=100_000)
    parser.add_argument('--kills', type=int, default=50)
    parser.add_argument('--jobs', type=int, default=2)
    parser.add_argument('--seed', type=int, default=time.time_ns() % 1_000_000)
    parser.add_argument('--table')
    given = parser.parse_args()
    print(f'seed {given.seed}', flush=True)
    sources = pathlib.Path(__file__).resolve().parents[2]
    bench = Bench(given.program, sources, None, given.seed)
    try:
        rows, faults = campaign(bench, given.cases, given.kills, given.jobs)
    finally:
        bench.close()
    for name, value in rows:
        print(f'{name}: {value}')
    for fault in faults:
        print('FAILED', fault)
    whole = given.cases == 100_000 and given.kills == 50
    if given.table:
        pathlib.Path(given.table).write_text(
            measured(rows, sources, '' if whole else f' (of it {given.cases} cases, {given.kills} kills)'))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
