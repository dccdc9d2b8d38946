"""Sweeps by executors: the table has the same bytes whatever runs the cases, and whatever dies on the way."""

import concurrent.futures
import multiprocessing
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import textwrap
import time

import numpy
import pytest

import withy

SCENE = """
format: withy/1
time: {end: 1, output: 0.5}
gravity: [0, -9.81, 0]
bodies: {bob: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0], frames: {top: {position: [0, 1, 0]}}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: bob.top}}
initial: {hinges: {axle: {position: [0.5]}}}
"""

PLAN = """
format: withy-sweep/1
scene: scene.yaml
vary:
  bodies.bob.mass: {grid: [1, 2]}
  initial.hinges.axle.position.0: {normal: {mean: 0.5, deviation: 0.1}}
cases: 60
keep: {final: [axle]}
"""


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    (tmp_path / "plan.yaml").write_text(PLAN)
    return tmp_path / "plan.yaml"


@pytest.fixture
def undisturbed(plan):
    return withy.sweep(plan, out=plan.parent / "undisturbed")


def table(result):
    assert (result.cases, result.done, result.failed, result.stopped) == (120, 120, 0, None)
    return (result.path / "table.csv").read_bytes()


def processes():
    # Of their own, not copies of a process that has threads.
    return concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn"))


def test_a_result_is_the_table_by_names(undisturbed):
    assert list(undisturbed["case"]) == list(range(120))
    mass, angle, end = (undisturbed[c] for c in ("bodies.bob.mass", "initial.hinges.axle.position.0", "final.axle[rad]"))
    # A physical pendulum about its top, inertia 0.2 + m: the end by an integrator of its own.
    case = 77
    y, h = numpy.array([angle[case], 0.0]), 1e-3
    f = lambda y: numpy.array([y[1], -mass[case] * 9.81 / (0.2 + mass[case]) * numpy.sin(y[0])])  # noqa: E731
    for _ in range(1000):
        k1 = f(y)
        k2 = f(y + h / 2 * k1)
        k3 = f(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(y + h * k3))
    assert end[case] == pytest.approx(y[0], abs=1e-5)
    assert set(undisturbed["status"]) == {"completed"}
    with pytest.raises(KeyError, match="did you mean 'final.axle"):
        undisturbed["final.axle"]


def test_threads_and_processes_make_the_same_table_and_nothing_runs_twice(plan, undisturbed):
    with concurrent.futures.ThreadPoolExecutor(3) as threads:
        assert table(withy.sweep(plan, threads, out=plan.parent / "threads", parts=7)) == table(undisturbed)
    told = []
    store = plan.parent / "processes"
    with processes() as executor:
        first = withy.sweep(plan, executor, out=store, parts=5, progress=lambda done, all: told.append((done, all)))
        assert table(first) == table(undisturbed)
        assert [done for done, _ in told] == [24, 48, 72, 96, 120] and told[0][1] == 120
        written = {file: file.stat().st_size for file in (store / "segments").iterdir()}
        assert table(withy.sweep(plan, executor, out=store, parts=3)) == table(undisturbed)
    assert sum(f.stat().st_size for f in written) == sum(written.values())


def _run_and_stay(task, *arguments):
    """A task that has run its cases and has not said so."""
    task(*arguments)
    time.sleep(600)


class Staying(concurrent.futures.Executor):
    """Processes that come to the end of their first tasks only: however fast they are, some are at work when one is killed."""

    def __init__(self, pool, ending):
        self.pool, self.ending = pool, ending

    def submit(self, task, *arguments):
        self.ending -= 1
        return self.pool.submit(task, *arguments) if self.ending >= 0 else self.pool.submit(_run_and_stay, task, *arguments)


def test_a_killed_worker_loses_no_case_and_leaves_no_process(plan, undisturbed):
    store = plan.parent / "killed"
    killed, workers = [], []
    with processes() as executor:

        def kill(done, all):  # once: the pool ends the others, and a process that has ended cannot be killed
            if not killed:
                workers.extend(executor._processes.values())
                killed.append(workers[0].pid)
                os.kill(killed[0], signal.SIGKILL)

        with pytest.raises(concurrent.futures.BrokenExecutor):
            withy.sweep(plan, Staying(executor, 20), out=store, parts=60, progress=kill)
    assert killed
    for worker in workers:  # the pool ends those that were not killed; else Python waits for them without end
        worker.join(60)
    left = [worker for worker in workers if worker.is_alive()]
    for worker in left:
        worker.kill()
    assert not left
    with processes() as executor:
        assert table(withy.sweep(plan, executor, out=store, parts=60)) == table(undisturbed)


class FirstOnly(concurrent.futures.Executor):
    """Runs the first task at once and no other, as a pool does whose workers are all busy."""

    def __init__(self):
        self.waiting = []

    def submit(self, task, *arguments):
        done = concurrent.futures.Future()
        if arguments[2] == 1:
            done.set_result(task(*arguments))
        else:
            self.waiting.append(done)
        return done


def test_the_commands_of_failures_name_the_folders_of_plugins(plan):
    mine = plan.parent / "my plugins"
    mine.mkdir()
    (plan.parent / "fails.yaml").write_text(PLAN.replace("grid: [1, 2]", "normal: {mean: 1, deviation: 1}"))
    store = plan.parent / "store"
    assert withy.sweep(plan.parent / "fails.yaml", out=store, plugins=[mine]).failed > 1
    assert f"fails.yaml --plugins '{mine}' " in (store / "failed.csv").read_text().splitlines()[-1]


def test_bad_plans_and_foreign_stores_are_refused_and_a_plan_may_stop_at_a_failure(plan):
    store = plan.parent / "store"
    with pytest.raises(withy.SceneError, match="unknown key \"mas\"; did you mean 'mass'"):
        (plan.parent / "bad.yaml").write_text(PLAN.replace("bob.mass", "bob.mas"))
        withy.sweep(plan.parent / "bad.yaml", out=store)
    withy.sweep(plan, out=store)
    (plan.parent / "other.yaml").write_text(PLAN.replace("0.1", "0.2"))
    with pytest.raises(withy.StoreError, match="holds the cases of another plan"):
        withy.sweep(plan.parent / "other.yaml", out=store)
    assert withy.sweep(plan.parent / "other.yaml", out=store, force=True).done == 120
    (plan.parent / "stops.yaml").write_text(PLAN.replace("grid: [1, 2]", "normal: {mean: 1, deviation: 1}") + "failures: stop\n")
    begins = FirstOnly()
    ended = withy.sweep(plan.parent / "stops.yaml", begins, out=store, parts=4, force=True)
    assert "need finite >= 0" in ended.stopped and ended.failed == 1 and ended.done < 15
    assert all(task.cancelled() for task in begins.waiting) and len(begins.waiting) == 3
    assert numpy.isnan(ended["final.axle[rad]"][ended["status"] == "refused"]).all()
    with pytest.raises(ValueError, match="parts: got 0"):
        withy.sweep(plan, out=store, parts=0)


class Meddler(concurrent.futures.Executor):
    """Changes the plan before each task, as somebody does who edits it while a cluster is at work."""

    def __init__(self, plan):
        self.plan = plan

    def submit(self, task, *arguments):
        self.plan.write_text(PLAN.replace("deviation: 0.1", "deviation: 0.2"))
        withy._sweep._open.clear()  # as a worker that has just been started
        done = concurrent.futures.Future()
        try:
            done.set_result(task(*arguments))
        except Exception as error:
            done.set_exception(error)
        return done


def test_a_plan_that_changes_on_the_way_is_not_mixed_into_the_store(plan):
    with pytest.raises(withy.StoreError, match="another plan"):
        withy.sweep(plan, Meddler(plan), out=plan.parent / "mixed", parts=2)


def test_dask_loses_no_case_with_a_killed_worker(plan, undisturbed):
    distributed = pytest.importorskip("distributed", reason="Dask is not there (Debian: python3-distributed)")
    import dask

    with dask.config.set({"distributed.comm.timeouts.connect": "5s"}), \
            distributed.LocalCluster(2, processes=True, threads_per_worker=1, dashboard_address=None) as cluster, \
            distributed.Client(cluster) as client:
        killed = []

        def kill(done, all):
            if not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        store = plan.parent / "dask"
        try:  # Dask runs again what the worker was at, but may fail to fetch what it had said
            withy.sweep(plan, client.get_executor(), out=store, parts=60, progress=kill)
        except Exception as failed:
            print("Dask failed:", failed)
        assert killed
        assert table(withy.sweep(plan, client.get_executor(), out=store, parts=12)) == table(undisturbed)


def test_mpi_makes_the_same_table(plan, undisturbed):
    pytest.importorskip("mpi4py", reason="mpi4py is not there (Debian: python3-mpi4py)")
    if not shutil.which("mpiexec"):
        pytest.skip("mpiexec is not there (Debian: openmpi-bin)")
    script = plan.parent / "sweep.py"
    script.write_text(textwrap.dedent(f"""
        import withy
        from mpi4py.futures import MPIPoolExecutor
        if __name__ == "__main__":
            with MPIPoolExecutor() as executor:
                print(withy.sweep({str(plan)!r}, executor, out={str(plan.parent / "mpi")!r}, parts=9).done)
        """))
    done = subprocess.run(["mpiexec", "--allow-run-as-root", "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures",
                           str(script)], text=True, capture_output=True, timeout=120)
    assert done.returncode == 0 and done.stdout.split()[-1] == "120", done.stdout + done.stderr
    assert pathlib.Path(plan.parent / "mpi/table.csv").read_bytes() == table(undisturbed)
