#!/usr/bin/env python3
"""A sweep through Dask whose workers are killed on the way: its table is that of the undisturbed one, byte by byte.

dask_kills.py [--cases 100000] [--kills 5] [--table FILE]

Needs the Python module on PYTHONPATH, and Dask (Debian: python3-distributed). Status 1 where a table differs.
"""
import argparse
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import sweep_kills  # noqa: E402


def with_dask(plan, store, kills):
    """How many workers were killed, and how often the sweep was begun."""
    import dask
    import distributed
    import withy

    killed = []
    with dask.config.set({'distributed.comm.timeouts.connect': '5s', 'distributed.scheduler.allowed-failures': 4 * kills}), \
            distributed.LocalCluster(2, processes=True, threads_per_worker=1, dashboard_address=None) as cluster, \
            distributed.Client(cluster) as client:

        def kill(done, cases):
            """One worker and the other by turns, at equal distances."""
            if len(killed) == kills or done * (kills + 1) < (len(killed) + 1) * cases:
                return
            worker = list(cluster.workers.values())[len(killed) % 2]
            if worker.pid:  # null while it is started again
                killed.append(worker.pid)
                os.kill(worker.pid, signal.SIGKILL)

        for begun in range(1, kills + 2):
            try:  # Dask runs again what a worker was at, but may fail to fetch what it had said
                withy.sweep(plan, client.get_executor(), out=store, parts=64, progress=kill)
                return len(killed), begun
            except Exception as failed:  # noqa: BLE001
                print('Dask failed:', failed, flush=True)
    raise SystemExit(f'the sweep did not end, begun {kills + 1} times')


def main():
    import withy

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--cases', type=int, default=100_000)
    parser.add_argument('--kills', type=int, default=5)
    parser.add_argument('--table')
    given = parser.parse_args()
    sources = pathlib.Path(__file__).resolve().parents[2]
    folder = pathlib.Path(tempfile.mkdtemp(prefix='withy-dask-'))
    try:
        (folder / 'scenes').symlink_to(sources / 'scenes')
        plan = folder / 'plan.yaml'
        plan.write_text(sweep_kills.PLAN.format(cases=given.cases))
        began = time.monotonic()
        withy.sweep(plan, out=folder / 'whole', jobs=2)
        alone = time.monotonic() - began
        began = time.monotonic()
        killed, begun = with_dask(plan, folder / 'store', given.kills)
        through = time.monotonic() - began
        same = all((folder / 'whole' / t).read_bytes() == (folder / 'store' / t).read_bytes() for t in sweep_kills.TABLES)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    rows = [('cases', given.cases), ('wall time undisturbed, 2 threads', f'{alone:.0f} s'),
            ('wall time through Dask, 2 workers', f'{through:.0f} s'), ('workers killed', killed),
            ('times that the sweep was begun', begun), ('tables the same, byte by byte', 'yes' if same else 'no')]
    for name, value in rows:
        print(f'{name}: {value}')
    if given.table:
        text = sweep_kills.measured(rows, sources, '').replace('sweep-kills', 'dask-kills', 1)
        pathlib.Path(given.table).write_text(text)
    return 0 if same and killed == given.kills else 1


if __name__ == '__main__':
    sys.exit(main())
