"""Many cases of a scene, run by whatever executor there is."""

from __future__ import annotations

import concurrent.futures
import csv
import os
import pathlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy

from . import _withy
from ._errors import StoreError
from ._library import encoded, folders, library
from ._result import unknown

if TYPE_CHECKING:
    from numpy.typing import NDArray

Path = Union[str, "os.PathLike[str]"]
Key = tuple[str, str, tuple[str, ...]]

# Of a process that runs parts of a sweep: the last one it opened.
_open: dict[Key, _withy.Sweep] = {}


def _engine(key: Key, force: bool) -> _withy.Sweep:
    plan, store, plugins = key
    return _withy.Sweep(library(plugins), encoded(plan), encoded(store), force, [encoded(folder) for folder in plugins])


def _opened(key: Key, fingerprint: str) -> _withy.Sweep:
    opened = _open.get(key)  # threads of several sweeps may be here at once
    if opened is None or opened.fingerprint != fingerprint:
        opened = _engine(key, False)
        if opened.fingerprint != fingerprint:
            raise StoreError(f"{key[0]}: this process reads another plan, scene or plugins than the one that began the sweep")
        _open.clear()
        _open[key] = opened
    return opened


def _run_part(key: Key, fingerprint: str, part: int, parts: int, jobs: int) -> tuple[int, int, str | None]:
    """In a worker: runs what the store lacks of the cases whose number is part - 1 modulo parts."""
    cases, before, ran, stop = _opened(key, fingerprint).run(part, parts, jobs, None)
    return cases, before + ran, stop


class SweepResult(Mapping[str, "NDArray[numpy.float64]"]):
    """What a sweep has: a mapping of the columns of its table.csv to arrays, a row a case in the order of the plan.

    Attributes:
        path: of the store, with table.csv, statistics.csv, indices.csv, failed.csv and report.html.
        cases: how many the plan has.
        done: how many have run, those that failed included.
        failed: how many did not come to their end; their numbers are nan, ``result["status"]`` says how they ended.
        stopped: why the sweep ended at a failure, as its plan says; None where it did not.
    """

    def __init__(self, path: pathlib.Path, cases: int, done: int, failed: int, stopped: str | None) -> None:
        self.path, self.cases, self.done, self.failed, self.stopped = path, cases, done, failed, stopped
        self._columns: dict[str, list[str]] | None = None

    def _table(self) -> dict[str, list[str]]:
        if self._columns is None:
            with open(self.path / "table.csv", newline="", encoding="utf-8") as file:
                head, *rows = csv.reader(file)
            self._columns = {name: [row[i] for row in rows] for i, name in enumerate(head)}
        return self._columns

    def __getitem__(self, column: str) -> NDArray[numpy.float64]:
        """Numbers in SI units [cases], or texts where not all are numbers.

        Raises:
            KeyError: with the nearest name where there is no such column.
        """
        table = self._table()
        if column not in table:
            raise unknown("column", column, list(table))
        try:
            return numpy.array([float(cell) if cell else numpy.nan for cell in table[column]])
        except ValueError:
            return numpy.array(table[column])

    def __iter__(self) -> Iterator[str]:
        return iter(self._table())

    def __len__(self) -> int:
        return len(self._table())

    def __repr__(self) -> str:
        return f"<withy.SweepResult {self.path}: {self.cases} cases, {self.done} done, {self.failed} failed>"


def sweep(plan: Path, executor: concurrent.futures.Executor | None = None, *, out: Path, jobs: int = 0,
          parts: int | None = None, plugins: Sequence[Path] = (), force: bool = False,
          progress: Callable[[float, float], Any] | None = None) -> SweepResult:
    """Runs the cases of a plan that its store lacks, and makes the tables: ``withy sweep run`` by any executor.

    A worker that dies loses the case it was at and no other: the executor's error is raised, and the same call goes on
    from there. The table has the same bytes whatever runs the cases, in whatever order, however often interrupted.

    Args:
        plan: its file.
        executor: of concurrent.futures or alike: processes, ``dask.distributed.Client(...).get_executor()``,
            ``mpi4py.futures.MPIPoolExecutor()``. Workers read plan and store by the same paths. None: threads here.
        out: folder of the store, on a file system that all workers share.
        jobs: threads of each task; 0: one, and without an executor one a core.
        parts: tasks that the executor gets, case i in part i modulo ``parts``; 64 where left out.
        plugins: folders with plugins of your own.
        force: replace another sweep that the folder holds.
        progress: called with the cases done and all cases.

    Raises:
        SceneError: where the plan or its scene has problems, all of them.
        StoreError: where the folder holds something else, or another process runs the same part.
        ValueError: where ``parts`` is less than 1.
    """
    if parts is not None and parts < 1:
        raise ValueError(f"parts: got {parts}; need at least 1")
    key = (os.path.abspath(os.fsdecode(plan)), os.path.abspath(os.fsdecode(out)), folders(plugins))
    own = _engine(key, force)
    stopped: str | None = None
    if executor is None:
        *_, stopped = own.run(1, 1, jobs, progress)
    else:
        parts = min(parts or 64, own.size)
        tasks = [executor.submit(_run_part, key, own.fingerprint, part, parts, max(jobs, 1))
                 for part in range(1, parts + 1)]
        try:
            done = 0
            for task in concurrent.futures.as_completed(tasks):
                _, here, stop = task.result()
                done += here
                if progress is not None:
                    progress(done, own.size)
                if stop is not None:
                    stopped = stop
                    break
        except concurrent.futures.BrokenExecutor:
            # The executor is ending all tasks with this error. Where it meets one that has been cancelled meanwhile,
            # CPython 3.11's pool of processes dies of it, leaves its other processes, and the program never ends.
            concurrent.futures.wait(tasks)
            raise
        finally:  # after an error, or a failure at which the plan stops
            running = [task for task in tasks if not task.cancel()]
        concurrent.futures.wait(running)  # parts that have begun go on to their end
    cases, done, failed = _withy.collect(encoded(key[1]))
    return SweepResult(pathlib.Path(key[1]), cases, done, failed, stopped)
