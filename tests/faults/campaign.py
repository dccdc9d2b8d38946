#!/usr/bin/env python3
"""The fault campaign: what a power cut, a full disk, a careless copy or a bad plugin does to the program.

campaign.py --program build/release/bin/withy --preload libfaults.so [--zoo FOLDER] [--share 0.02] [--only GROUP]
            [--seed N] [--table FILE]

Prints a table, one row a kind of fault, and every fault that did not end as it should; status 1 where there is one.
"""
import argparse
import datetime
import pathlib
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from common import Bench  # noqa: E402
from damage import damage  # noqa: E402
from hostile import hostile  # noqa: E402
from inputs import inputs  # noqa: E402
from kills import kills  # noqa: E402
from system import system  # noqa: E402

GROUPS = {'kills': kills, 'system': system, 'damage': damage, 'inputs': inputs, 'hostile': hostile}


def cells(row):
    return [row.group, row.what, str(row.tried), 'all' if not row.failures else f'all but {len(row.failures)}']


def measured(rows, sources, share):
    """In the form of docs/measured, for scripts/docs.sh."""
    part = '' if share == 1 else f', {share} of the campaign'
    commit = subprocess.run(['git', 'rev-parse', '--short', 'HEAD'], cwd=sources, capture_output=True, text=True)
    lines = ['command: ninja -C build/release faults' + part, f'commit: {commit.stdout.strip()}',
             f'date: {datetime.date.today()}', '', 'fault\tof\ttried\tas it should']
    return '\n'.join(lines + ['\t'.join(cells(row)) for row in rows]) + '\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--program', required=True)
    parser.add_argument('--preload', required=True)
    parser.add_argument('--zoo')
    parser.add_argument('--share', type=float, default=1.0, help='of the whole campaign')
    parser.add_argument('--only', choices=GROUPS, action='append')
    parser.add_argument('--seed', type=int, default=time.time_ns() % 1_000_000)
    parser.add_argument('--table')
    given = parser.parse_args()
    print(f'seed {given.seed}', flush=True)
    rows = []
    sources = pathlib.Path(__file__).resolve().parents[2]
    for name in given.only or GROUPS:
        bench = Bench(given.program, sources, given.preload, given.seed)
        bench.zoo = given.zoo
        began = time.monotonic()
        try:
            made = GROUPS[name](bench, given.share)
        finally:
            bench.close()
        rows += [row for row in made if row.tried]
        for row in made:
            for failure in row.failures:
                print(f'FAILED {row.group}, {row.what}: {failure}', flush=True)
        print(f'{name}: {sum(r.tried for r in made)} faults in {time.monotonic() - began:.0f} s', flush=True)
    for row in rows:
        print(' | '.join(cells(row)))
    if given.table:
        pathlib.Path(given.table).write_text(measured(rows, sources, given.share))
    return 1 if any(row.failures for row in rows) else 0


if __name__ == '__main__':
    sys.exit(main())
