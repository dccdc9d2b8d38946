"""Files of every kind that is read, cut short, with bits, blocks and lines changed: an answer, never a crash."""
import json
import time

from common import PLAN, Row, run_command

MOST_SECONDS, MOST_MEGABYTES = 60, 1500


def spoil(random, content):
    """One damage of a kind that copies, disks and editors do."""
    content = bytearray(content)
    for _ in range(random.choice((1, 1, 1, 3))):
        at = random.randrange(len(content) + 1)
        length = min(random.choice((1, 2, 16, 512)), len(content) - at)
        kind = random.randrange(8)
        if kind == 0:
            del content[at:]
        elif kind == 1 and length:
            content[at] ^= 1 << random.randrange(8)
        elif kind == 2:
            content[at:at + length] = bytes(length)
        elif kind == 3:
            del content[at:at + length]
        elif kind == 4:
            content[at:at] = content[at:at + length]
        elif kind == 5:
            content[at:at] = random.randbytes(random.choice((1, 4, 64)))
        elif kind == 6:
            content[at:at] = random.choice((b'1e999', b'nan', b'-1', b'\xff', b'9' * 30, b'\n', b'{' * 40, b',', b'"'))
        else:
            line = content.rfind(b'\n', 0, at) + 1
            end = content.find(b'\n', at)
            content[line:line] = content[line:end + 1] if end >= 0 else b''
    return bytes(content)


SCENE = 'scenes/two-link-slew.yaml'
SHORT = ['--set', 'time.end=0.05']
MOTION = 't[s],shoulder[rad],elbow[rad]\n' + ''.join(f'{t / 50},{t * t / 1e5},{-t * t / 1e5}\n' for t in range(26))
TUNE_LIST = 'mass\n1.3\n1.34\n1.36\n'


def inputs_of(bench):
    """Kind, file, command that reads it."""
    mesh = 'mesh/cantilever'
    for end in ('inp', 'dof', 'mas', 'sti'):
        bench.write(f'{mesh}.{end}', bench.read(f'scenes/meshes/cantilever.{end}'))
    for name in ('double-pendulum.urdf', 'cart-pole.xml', 'blade.dat', 'tower.dat'):
        bench.write(f'models/{name}', bench.read(f'scenes/models/{name}'))
    for name in ('two-link-slew', 'imported-boom', 'driven-arm'):
        bench.write(f'{name}.yaml', bench.read(f'scenes/{name}.yaml'))
    bench.write('cantilever.SID_FEM', bench.read('scenes/cantilever.SID_FEM'))
    bench.write('motion.csv', MOTION)
    bench.write('list.csv', TUNE_LIST)
    bench.write('plan.yaml', PLAN.replace('cases: 60', 'cases: 2'))
    bench.write('list.yaml', PLAN.split('vary:')[0] + 'vary: {bodies.link1.mass_per_length: '
                '{list: {file: list.csv, column: mass}}}\nkeep: {final: [shoulder]}\n')
    bench.run(['run', SCENE, *SHORT, '--out', 'kept'])
    bench.write('state.json', json.dumps(json.loads(bench.read('kept/run.json')).get('final', {})))
    mesh_import = ['import', mesh, '--root', 'ROOT', '--interface', 'TIP', '--modes', '4', '--highest', '700',
                   '--out', 'made.SID_FEM']
    return [
        ('scene', 'two-link-slew.yaml', ['run', 'two-link-slew.yaml', *SHORT, '--out', 'out']),
        ('scene with a mesh', 'imported-boom.yaml', ['run', 'imported-boom.yaml', *SHORT, '--out', 'out']),
        ('Standard Input Data', 'cantilever.SID_FEM', ['run', 'imported-boom.yaml', *SHORT, '--out', 'out']),
        ('deck of CalculiX or Abaqus', f'{mesh}.inp', mesh_import),
        ('matrices of CalculiX', f'{mesh}.sti', mesh_import),
        ('matrices of CalculiX', f'{mesh}.mas', mesh_import),
        ('freedoms of CalculiX', f'{mesh}.dof', mesh_import),
        ('recorded motion, CSV', 'motion.csv', ['inverse', SCENE, '--motion', 'motion.csv', '--out', 'out']),
        ('plan of a sweep', 'plan.yaml', ['sweep', 'run', 'plan.yaml', '--out', 'out', '--jobs', '1']),
        ('list of a sweep, CSV', 'list.csv', ['sweep', 'run', 'list.yaml', '--out', 'out', '--jobs', '1']),
        ('state', 'state.json', ['eval', SCENE, '--state', 'state.json']),
        ('URDF', 'models/double-pendulum.urdf', ['import', 'models/double-pendulum.urdf', '--out', 'made.yaml']),
        ('MJCF', 'models/cart-pole.xml', ['import', 'models/cart-pole.xml', '--out', 'made.yaml']),
        ('ElastoDyn', 'models/blade.dat', ['import', 'models/blade.dat', '--length', '60', '--out', 'made.yaml']),
        ('results.h5', 'kept/results.h5', ['plot', 'kept/results.h5', '--out', 'made.svg']),
        ('results.csv', 'kept/results.csv', ['plot', 'kept/results.csv', '--out', 'made.svg']),
        ('report.html', 'kept/report.html', ['report', 'kept/report.html', 'kept/report.html', '--out', 'made.html']),
        ('result.json', 'kept/result.json', ['run', SCENE, *SHORT, '--out', 'kept']),
    ]


def answered(bench, share, rows):
    for kind, file, command in inputs_of(bench):
        row = rows.setdefault(kind, Row('damage', kind))
        good = bench.read(file)
        bench.remove('out', 'made.SID_FEM', 'made.yaml', 'made.svg', 'made.html')
        if why := bench.run(command).fault({0}):
            row.note('undamaged ' + file, why)
            continue
        for n in range(max(2, round(60 * share))):
            bad = spoil(bench.random, good)
            bench.write(file, bad)
            bench.remove('out', 'made.SID_FEM', 'made.yaml', 'made.svg', 'made.html')
            ended = bench.run(command, seconds=MOST_SECONDS)
            why = ended.fault({0, 1, 2, 3}, 2000)
            if not why and ended.megabytes > MOST_MEGABYTES:
                why = f'{ended.megabytes:.0f} MB'
            if why:
                kept = f'/tmp/withy-fault-{kind.replace(" ", "-").replace(",", "")}-{n}'
                open(kept, 'wb').write(bad)
                why += f' (kept as {kept})'
            row.note(' '.join(command[:3]), why)
        bench.write(file, good)
        if file == 'kept/result.json':
            bench.remove('kept')


def checkpoints(bench, share, rows):
    """A run ended by SIGTERM: with one file of its folder damaged it goes on to the same bytes, or says why it cannot."""
    row = rows.setdefault('checkpoint', Row('damage', 'checkpoint, and the table of a run that goes on'))
    command = run_command(end=40)
    whole = bench.run(command.to('whole', bench))
    while not (bench.folder / 'half/checkpoint.previous.cbor').exists():
        bench.remove('half')
        process = bench.start(command.to('half', bench))
        time.sleep(bench.random.uniform(0.05, whole.seconds / 2))
        process.terminate()
        bench.end(process)
    half = {p.name: p.read_bytes() for p in (bench.folder / 'half').iterdir()}
    for _ in range(max(2, round(120 * share))):
        bench.remove('out')
        for name, content in half.items():
            bench.write(f'out/{name}', content)
        names = bench.random.choice([['checkpoint.cbor']] * 3 + [['checkpoint.cbor', 'checkpoint.previous.cbor']] +
                                    [['results.csv']] * 2)
        for name in names:
            bench.write(f'out/{name}', spoil(bench.random, half[name]))
        ended = bench.run([*command.arguments, '--out', 'out', '--resume'], seconds=MOST_SECONDS)
        why = ended.fault({0, 2})
        row.note(' and '.join(names), why or (command.difference('out', 'whole', bench) if ended.status == 0 else ''))


def stores(bench, share, rows):
    """Damage of a segment costs the cases it touches: they run again, and the table is the same."""
    row = rows.setdefault('store', Row('damage', 'store of a sweep'))
    points = rows.setdefault('points', Row('damage', 'finished points of a trade'))
    bench.write('plan.yaml', PLAN)
    command = ['sweep', 'run', 'plan.yaml', '--jobs', '1', '--out', 'whole']
    bench.remove('whole', 'out')
    bench.run(command)
    kept = {p.relative_to(bench.folder / 'whole'): p.read_bytes()
            for p in (bench.folder / 'whole').rglob('*') if p.is_file()}
    for _ in range(max(2, round(60 * share))):
        bench.remove('out')
        for name, content in kept.items():
            bench.write(f'out/{name}', content)
        name = bench.random.choice([n for n in kept if n.suffix in ('.segment', '.json')])
        bench.write(f'out/{name}', spoil(bench.random, kept[name]))
        ended = bench.run([*command[:-1], 'out'])
        why = ended.fault({0, 2})
        if not why and ended.status == 0 and bench.read('out/table.csv') != bench.read('whole/table.csv'):
            why = 'another table'
        row.note(str(name), why)
    bench.remove('whole', 'out')
    from common import trade_command
    trade = trade_command()
    bench.run(trade.to('whole', bench))
    bench.run(trade.to('out', bench))
    names = sorted(p.name for p in (bench.folder / 'out/points').iterdir())
    for _ in range(max(2, round(30 * share))):
        name = 'out/points/' + bench.random.choice(names)
        bench.write(name, spoil(bench.random, bench.read(name)))
        ended = bench.run(trade.to('out', bench))
        points.note(name, ended.fault({0}) or trade.difference('out', 'whole', bench))


def damage(bench, share):
    rows = {}
    answered(bench, share, rows)
    checkpoints(bench, share, rows)
    stores(bench, share, rows)
    return list(rows.values())
