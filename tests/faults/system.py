"""Disks that are full or broken, folders that go away, limits, signals, clocks, and two writers of one folder."""
import errno
import json
import os
import resource
import shutil
import signal
import subprocess
import time

from common import PLAN, Row, run_command, sweep_command, trade_command

ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS)


def commands():
    return [run_command(end=1), sweep_command(), trade_command()]


def again(bench, command, row, what, why):
    """After a fault: the same command makes the same result."""
    resumed = bench.run(command.to('out', bench))
    row.note(what, why or resumed.fault({0}) or command.difference('out', 'whole', bench))


def undisturbed(bench, row, command, fault=None):
    bench.remove('whole', 'out')
    whole = bench.run(command.to('whole', bench), fault=fault)
    if why := whole.fault({0}):
        row.note('undisturbed', why)
    return not why


def spoiled_calls(bench, share):
    rows = [Row('system', f'{os.strerror(e)}: every call from a random one on') for e in ERRORS]
    rows.append(Row('system', 'EIO once, in a random call'))
    rows.append(Row('system', 'short writes'))
    count = bench.folder / 'count'
    for command in commands():
        fault = {'WITHY_FAULT_PATH': 'whole/', 'WITHY_FAULT_COUNT': str(count)}
        calls = 'open+write+sync+close+rename'
        if not undisturbed(bench, rows[0], command, {**fault, 'WITHY_FAULT': f'{calls}:0:1000000000'}):
            continue
        most = int(count.read_text())
        kinds = [(row, str(e)) for row, e in zip(rows, ERRORS)] + [(rows[4], f'once{errno.EIO}'), (rows[5], 'short')]
        for row, kind in kinds:
            for _ in range(max(1, round(12 * share))):
                bench.remove('out')
                at = bench.random.randint(1, most)
                ended = bench.run(command.to('out', bench), fault={
                    'WITHY_FAULT_PATH': 'out/', 'WITHY_FAULT': f'{calls}:{kind}:{at}'})
                why = ended.fault({0, 3}, most_lines=2)
                # What was reported as done is there.
                if not why and ended.status == 0:
                    why = command.difference('out', 'whole', bench)
                again(bench, command, row, f'{command.name}, call {at} of {most}', why)
    return rows


def mounted(bench, size, then):
    """A small disk of its own for the folder `disk`; None where that is not permitted."""
    disk = bench.folder / 'disk'
    disk.mkdir(exist_ok=True)
    if subprocess.run(['mount', '-t', 'tmpfs', '-o', f'size={size}k', 'tmpfs', disk], capture_output=True).returncode:
        return None
    try:
        return then(disk)
    finally:
        subprocess.run(['umount', '-l', disk], check=True)


def disks(bench, share):
    full, locked = Row('disk', 'a full one (tmpfs)'), Row('disk', 'read-only')
    for command in commands():
        if not undisturbed(bench, full, command):
            continue
        needs = sum(f.stat().st_size for f in (bench.folder / 'whole').rglob('*') if f.is_file()) // 1024
        for _ in range(max(1, round(8 * share))):
            size = bench.random.randint(4, max(8, needs))

            def fill(disk):
                ended = bench.run(command.to('disk/out', bench))
                why = ended.fault({0, 3}, most_lines=2)
                subprocess.run(['mount', '-o', 'remount,size=64m', disk], check=True)
                resumed = bench.run(command.to('disk/out', bench))
                full.note(f'{command.name} on {size} kB', why or resumed.fault({0}) or
                          command.difference('disk/out', 'whole', bench))
                return True
            if mounted(bench, size, fill) is None:
                full.what += ': not permitted here'
                return [full]

        def forbid(disk):
            subprocess.run(['mount', '-o', 'remount,ro', disk], check=True)
            locked.note(command.name, bench.run(command.to('disk/out', bench)).fault({3}, most_lines=2))
            return True
        mounted(bench, 1024, forbid)
    return [full, locked]


def vanishing(bench, share):
    row = Row('disk', 'the folder is removed, or renamed, on the way')
    for command in commands():
        if not undisturbed(bench, row, command):
            continue
        for _ in range(max(1, round(6 * share))):
            bench.remove('out', 'away')
            began = time.monotonic()
            process = bench.start(command.to('out', bench))
            while not (bench.folder / 'out').exists() and process.poll() is None and time.monotonic() - began < 60:
                time.sleep(0.001)
            time.sleep(bench.random.uniform(0, 0.2))
            try:
                if bench.random.random() < 0.5:
                    (bench.folder / 'out').rename(bench.folder / 'away')
                else:
                    shutil.rmtree(bench.folder / 'out', ignore_errors=True)
            except OSError:
                pass
            ended = bench.end(process)
            why = ended.fault({0, 2, 3}, most_lines=3)
            bench.remove('out', 'away')
            again(bench, command, row, command.name, why)
    return [row]


def before_main(ended):
    """The status of a library that finds no room to begin, before the program does: these words are the C++ library's, and
    the program has its own for what ends it."""
    words = ended.err.strip()
    return {-signal.SIGABRT} if words == 'terminate called without an active exception' else set()


def limits(bench, share):
    memory, files = Row('limit', 'address space (prlimit)'), Row('limit', 'size of a file (SIGXFSZ)')
    for command in commands():
        if not undisturbed(bench, memory, command):
            continue
        for _ in range(max(2, round(14 * share))):
            bench.remove('out')
            size = bench.random.randint(20, 400) << 20
            ended = bench.run(command.to('out', bench), limits=[(resource.RLIMIT_AS, size)])
            # 127: the dynamic linker had not the room for the program.
            again(bench, command, memory, f'{command.name} in {size >> 20} MB', ended.fault({0, 3, 127} | before_main(ended)))
        for _ in range(max(2, round(6 * share))):
            bench.remove('out')
            size = bench.random.randint(0, 40) << 10
            ended = bench.run(command.to('out', bench), limits=[(resource.RLIMIT_FSIZE, size)])
            again(bench, command, files, f'{command.name} to {size} bytes', ended.fault({0, 3}, most_lines=2))
    return [memory, files]


def signals(bench, share):
    rows = [Row('signal', name) for name in ('SIGTERM', 'SIGHUP', 'SIGINT', 'SIGPIPE, SIGUSR1')]
    kinds = [[signal.SIGTERM], [signal.SIGHUP], [signal.SIGINT], [signal.SIGPIPE, signal.SIGUSR1]]
    for command in commands():
        began = time.monotonic()
        if not undisturbed(bench, rows[0], command):
            continue
        length = time.monotonic() - began
        for row, kind in zip(rows, kinds):
            for n in range(max(1, round(6 * share))):
                bench.remove('out')
                process = bench.start(command.to('out', bench))
                time.sleep(bench.random.uniform(0, length))
                sent = kind[n % len(kind)]
                process.send_signal(sent)
                # Before the program has begun to listen, and of those that it leaves alone, the signal ends it.
                again(bench, command, row, f'{command.name}, {sent.name}', bench.end(process).fault({0, 130, -sent}, 5)
                      .replace(f'status {-sent} without a word', ''))
    pipe = Row('signal', 'who reads the output goes away')
    for command in commands():
        if not undisturbed(bench, pipe, command):
            continue
        for _ in range(max(1, round(4 * share))):
            bench.remove('out')
            process = bench.start([*command.to('out', bench), '--json'])
            process.stdout.read(bench.random.randint(0, 20))
            process.stdout.close()
            process.stdout = None
            bench.end(process)
            again(bench, command, pipe, command.name, '')
    return rows + [pipe]


def clocks(bench, share):
    row = Row('clock', 'jumps of hours and years, both ways')
    for command in commands():
        if not undisturbed(bench, row, command):
            continue
        for _ in range(max(1, round(4 * share))):
            bench.remove('out')
            span = 10 ** bench.random.uniform(0, 8)
            ended = bench.run(command.to('out', bench), fault={'WITHY_CLOCK': f'{span:.0f}'})
            row.note(f'{command.name}, {span:.3g} s', ended.fault({0}) or command.difference('out', 'whole', bench))
    return [row]


def writers(bench, share):
    row = Row('writers', 'two of one folder')
    for command in commands():
        if not undisturbed(bench, row, command):
            continue
        for _ in range(max(1, round(6 * share))):
            bench.remove('out')
            first = bench.start(command.to('out', bench))
            time.sleep(bench.random.uniform(0, 0.1))
            second = bench.run(command.to('out', bench))
            why = bench.end(first).fault({0, 3}, 2) or second.fault({0, 2, 3}, 2)
            again(bench, command, row, command.name, why)
    return [row]


def system(bench, share):
    bench.write('plan.yaml', PLAN)
    rows = []
    for group in (spoiled_calls, disks, vanishing, limits, signals, clocks, writers):
        rows += group(bench, share)
    return rows
