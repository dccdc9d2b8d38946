"""Processes killed at random moments and begun again: the result is that of an undisturbed run, byte by byte."""
import json
import signal
import time

from common import INTEGRATORS, PLAN, Row, run_command, sweep_command, trade_command


def kept_points(bench, folder):
    """What a study or a sweep has reported as done: finished points, finished cases."""
    points = bench.folder / folder / 'points'
    return {p.name: p.read_bytes() for p in points.glob('*.json')} if points.is_dir() else {}


def kept_cases(bench, folder):
    status = bench.run(['sweep', 'status', folder, '--json'])
    return json.loads(status.out)['done'] if status.status == 0 else 0


def lost(before, after):
    if isinstance(before, int):
        return f'{before} cases were done, {after} are left' if after < before else ''
    gone = [name for name, content in before.items() if after.get(name) != content]
    return f'{gone} were done and are gone' if gone else ''


def killed_at_random(bench, row, command, kills, kept=None):
    """Three kills of a process before it may end, then the next folder."""
    began = time.monotonic()
    whole = bench.run(command.to('whole', bench))
    length = time.monotonic() - began
    if 'no integrator plugin' in whole.err:
        return
    if fault := whole.fault({0}):
        row.note('undisturbed', fault)
        return
    left = kills
    while left > 0:
        bench.remove('out')
        why = ''
        for _ in range(min(3, left)):
            before = kept(bench, 'out') if kept else None
            process = bench.start(command.to('out', bench))
            time.sleep(bench.random.uniform(0, length))
            process.send_signal(signal.SIGKILL)
            why = why or bench.end(process).fault({0, -signal.SIGKILL})
            if kept and not why:
                why = lost(before, kept(bench, 'out'))
            left -= 1
            row.note(command.name, '')
        resumed = bench.run(command.to('out', bench))
        why = why or resumed.fault({0}) or command.difference('out', 'whole', bench)
        if why:
            row.failures.append(f'{command.name}: {why}')
    bench.remove('out', 'whole')


def killed_while_writing(bench, row, command, kills, path):
    """Killed before a call that writes, syncs, closes or renames: moments that chance seldom hits."""
    count = bench.folder / 'count'
    fault = {'WITHY_FAULT_PATH': path, 'WITHY_FAULT_COUNT': str(count)}
    calls = 'write+sync+close+rename'
    whole = bench.run(command.to('whole', bench), fault={**fault, 'WITHY_FAULT': f'{calls}:0:1000000000'})
    if fault_of := whole.fault({0}):
        row.note('undisturbed', fault_of)
        return
    most = int(count.read_text())
    for _ in range(kills):
        bench.remove('out')
        at = bench.random.randint(1, max(1, most))
        ended = bench.run(command.to('out', bench), fault={**fault, 'WITHY_FAULT': f'{calls}:kill:{at}'})
        why = ended.fault({0, -signal.SIGKILL})
        resumed = bench.run(command.to('out', bench))
        row.note(f'{command.name}, before call {at} of {most}',
                 why or resumed.fault({0}) or command.difference('out', 'whole', bench))
    bench.remove('out', 'whole')


def kills(bench, share):
    """`share` of the whole: 1 makes 300 kills."""
    some = lambda n: max(1, round(n * share))
    bench.write('plan.yaml', PLAN)
    rows = [Row('kill -9', 'runs, all integrators, a checkpoint every 3 ms'), Row('kill -9', 'trade'),
            Row('kill -9', 'sweep, two threads'), Row('kill -9', 'before a call that writes a checkpoint or a table')]
    for integrator in INTEGRATORS if share == 1 else bench.random.sample(INTEGRATORS, 2):
        killed_at_random(bench, rows[0], run_command(integrator), some(15))
    killed_at_random(bench, rows[1], trade_command(), some(40), kept_points)
    killed_at_random(bench, rows[2], sweep_command(), some(40), kept_cases)
    killed_while_writing(bench, rows[3], run_command(), some(70), 'out/')
    return rows
