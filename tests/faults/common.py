"""What the groups of the campaign share: programs under faults, and what became of them."""
import dataclasses
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import tempfile
import time


@dataclasses.dataclass
class Row:
    """One line of the table: faults of a kind, and those that did not end as they should."""
    group: str
    what: str
    tried: int = 0
    failures: list = dataclasses.field(default_factory=list)

    def note(self, fault, why):
        """`why`: empty where all was well."""
        self.tried += 1
        if why:
            self.failures.append(f'{fault}: {why}')


@dataclasses.dataclass
class Ended:
    status: int  # minus the signal where one ended it
    out: str
    err: str
    seconds: float
    megabytes: float

    def fault(self, allowed, most_lines=None):
        """What is wrong with how it ended; statuses but 0 say why on standard error."""
        said = self.err.strip()
        if self.status not in allowed:
            return f'status {self.status}, expected one of {sorted(allowed)}: {said[-200:]}'
        if self.status not in (0, -signal.SIGKILL) and not said:
            return f'status {self.status} without a word'
        if most_lines and len(said.splitlines()) > most_lines:
            return f'{len(said.splitlines())} lines where one says it: {said[:200]}'
        return ''


class Bench:
    """A program in a folder of its own."""

    def __init__(self, program, sources, preload, seed):
        self.program = os.path.abspath(program)
        self.sources = pathlib.Path(sources).resolve()
        self.preload = preload and os.path.abspath(preload)
        self.random = random.Random(seed)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix='withy-faults-'))
        (self.folder / 'scenes').symlink_to(self.sources / 'scenes')

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, arguments, fault=None, limits=(), out=subprocess.PIPE, environment=None):
        """fault: variables of preload.cpp; limits: pairs for setrlimit."""
        env = dict(os.environ, **(environment or {}))
        if fault:
            env.update(fault, LD_PRELOAD=self.preload)

        def limit():
            for what, size in limits:
                resource.setrlimit(what, (size, size))
        return subprocess.Popen([self.program, *arguments], cwd=self.folder, env=env, stdout=out,
                                stderr=subprocess.PIPE, preexec_fn=limit if limits else None)

    @staticmethod
    def end(process, seconds=600):
        """Waits; what hangs is killed, and its status is None."""
        began = time.monotonic()
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        try:
            out, err = process.communicate(timeout=seconds)
            status = process.returncode
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            status = None
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        text = [(b or b'').decode(errors='replace') for b in (out, err)]
        # The greatest of all children: greater than before only where this one was.
        return Ended(status, *text, time.monotonic() - began, peak / 1024 if peak > before else 0)

    def run(self, arguments, seconds=600, **how):
        return self.end(self.start(arguments, **how), seconds)

    def read(self, name):
        return (self.folder / name).read_bytes()

    def remove(self, *names):
        for name in names:
            path = self.folder / name
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def outcome(self, folder):
        """Everything of a run that is the same whenever it is made."""
        run = json.loads(self.read(folder + '/run.json'))
        for key in ('cpu_seconds', 'folder'):
            run.pop(key, None)
        run.get('certificate', {}).pop('estimated_error', None)
        return self.read(folder + '/results.csv'), json.dumps(run, sort_keys=True)


@dataclasses.dataclass
class Command:
    """A command that leaves results in a folder, and how it is repeated and compared."""
    name: str
    arguments: list
    resumes: bool = False  # with --resume where there is a checkpoint
    tables: tuple = ()     # files that are the same whenever it is made

    def to(self, folder, bench):
        more = []
        there = [(bench.folder / folder / f'checkpoint{g}.cbor').exists() for g in ('', '.previous')]
        if self.resumes and any(there):
            more = ['--resume']
        return [*self.arguments, '--out', folder, *more]

    def result(self, folder, bench):
        if self.resumes:
            return bench.outcome(folder)
        return [self.stable(bench.read(f'{folder}/{table}')) for table in self.tables]

    @staticmethod
    def stable(table):
        """Without what was measured by a clock: CPU times, and who is best by them."""
        rows = [line.split(b',') for line in table.splitlines()]
        kept = [i for i, name in enumerate(rows[0]) if name not in (b'cpu[s]', b'pareto')] if rows else []
        return [[row[i] for i in kept] if len(row) == len(rows[0]) else row for row in rows]

    def difference(self, folder, whole, bench):
        """Why the folder does not hold the same as the undisturbed one."""
        try:
            same = self.result(folder, bench) == self.result(whole, bench)
        except (OSError, ValueError) as e:
            return str(e)
        return '' if same else 'the result is not that of an undisturbed run'


INTEGRATORS = [
    '{name: rk4, step: 0.0005}', '{name: rk4-adaptive, rtol: 1e-9}', '{name: dopri5, rtol: 1e-9}',
    '{name: dop853, rtol: 1e-11}', '{name: rosenbrock-w, rtol: 1e-6}', '{name: imex, rtol: 1e-6}',
    '{name: radau, rtol: 1e-6}', '{name: gauss, step: 0.005}', '{name: generalized-alpha, step: 0.001}',
    '{name: cvode, rtol: 1e-7}']

PLAN = '''format: withy-sweep/1
scene: scenes/two-link-slew.yaml
set: {integrator.rtol: 1e-5, time.end: 0.4}
vary:
  loads.slew.time_scale: {grid: [0.5, 1.0]}
  bodies.link1.mass_per_length: {normal: {mean: 1.33937, deviation: 0.02}}
cases: 60
seed: 7
keep: {final: [shoulder, elbow], peak: [link1.tip.deflection_y]}
'''


def run_command(integrator='{name: dopri5, rtol: 1e-9}', end=3, more=()):
    return Command('run ' + integrator.split()[1].strip(',}'), [
        'run', 'scenes/driven-arm.yaml', '--set', 'integrator=' + integrator, '--set', f'time.end={end}',
        '--checkpoint', '0.003', *more], resumes=True)


def sweep_command(jobs=2):
    return Command('sweep', ['sweep', 'run', 'plan.yaml', '--jobs', str(jobs)],
                   tables=('table.csv', 'statistics.csv', 'failed.csv'))


def trade_command():
    return Command('trade', ['trade', 'scenes/two-link-slew.yaml', '--modes', '1,2', '--formulations', 'ruthless,quadratic',
                             '--integrators', 'dopri5', '--tolerances', '1e-3,1e-4', '--set', 'time.end=0.3',
                             '--jobs', '2'], tables=('trade.csv',))
