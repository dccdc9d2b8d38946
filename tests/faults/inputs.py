"""Small inputs that ask for much: memory and time stay bounded, and pipes that nobody writes into are given up."""
import os

from common import Row

MOST_SECONDS, MOST_MEGABYTES = 60, 1000


def chain(n, more=''):
    lines = ['format: withy/1', 'time: {end: 0.01}', 'bodies:']
    lines += [f'  b{i}: {{type: rigid, mass: 1, inertia: [1,1,1,0,0,0], frames: {{tip: {{position: [1,0,0]}}}}}}'
              for i in range(n)]
    lines.append('hinges:')
    lines += [f'  h{i}: {{type: revolute, axis: [0,0,1], parent: {"world" if i == 0 else f"b{i - 1}.tip"}, child: b{i}}}'
              for i in range(n)]
    return '\n'.join(lines) + '\n' + more


def decks(bench):
    deck = bench.read('scenes/meshes/cantilever.inp').decode()
    sets = {
        'a set of itself': '*NSET, NSET=D\n1, 2\n' + 'D, D\n' * 60,
        'sets of each other': '*NSET, NSET=A\n1, 2\n' + ''.join(f'*NSET, NSET={x}\n{y}, {y}\n' for x, y in 30 * ('BA', 'AB')),
        'a range of all numbers': '*NSET, NSET=G, GENERATE\n-9223372036854775807, 9223372036854775807, 1\n',
        'a range to the last number': '*NSET, NSET=G, GENERATE\n9223372036854775800, 9223372036854775807, 5\n',
        'a range of 1e8': '*NSET, NSET=G, GENERATE\n1, 100000000, 1\n',
        'many ranges': ''.join(f'*NSET, NSET=G{i}, GENERATE\n1, 1000000, 1\n' for i in range(1000)),
        'a file of itself': '*INCLUDE, INPUT=deck.inp\n',
    }
    for end in ('dof', 'mas', 'sti'):
        bench.write(f'deck.{end}', bench.read(f'scenes/meshes/cantilever.{end}'))
    for what, text in sets.items():
        yield what, 'deck.inp', deck + text


def inputs(bench, share):
    bounded, pipes = Row('input', 'small files that ask for much'), Row('input', 'pipes and endless files')

    def ask(row, what, command, allowed, seconds=MOST_SECONDS):
        ended = bench.run(command, seconds=seconds)
        why = ended.fault(allowed)
        if not why and ended.megabytes > MOST_MEGABYTES:
            why = f'{ended.megabytes:.0f} MB'
        row.note(what, why)
    for what, name, text in decks(bench):
        bench.write(name, text)
        ask(bounded, what, ['import', 'deck', '--root', 'ROOT', '--interface', 'TIP', '--modes', '4', '--highest', '700',
                            '--out', 'made.SID_FEM'], {0, 2})
    many = 20000 if share > 0.1 else 2000
    scenes = {
        'wrong names': chain(3, 'loads:\n' + ''.join(
            f'  l{i}: {{type: hinge-effort, hinge: hh{i}, law: sine, amplitude: 1, period: 1}}\n' for i in range(many))),
        'wrong keys': 'format: withy/1\nbodies:\n' + ''.join(
            f'  b{i}: {{type: rigid, mass: 1, masss: 2}}\n' for i in range(many)),
        'bodies without hinges': 'format: withy/1\nbodies:\n' + ''.join(
            f'  b{i}: {{type: rigid, mass: 1, inertia: [1,1,1,0,0,0]}}\n' for i in range(10 * many)),
        'brackets': '[' * 100000,
        'a number of modes': 'format: withy/1\nbodies:\n  b: {type: beam, length: 1, mass_per_length: 1, bending_y: '
                             '{stiffness: 1, modes: 1000000000}}\nhinges:\n  h: {type: weld, parent: world, child: b}\n',
        'a name with NUL': bench.read('scenes/imported-boom.yaml').decode().replace(
            'cantilever.SID_FEM', '"cantilever.SID_FEM\\0x"'),
        'outputs without end': bench.read('scenes/pendulum.yaml').decode() + 'name: "x"\n',
    }
    for what, text in scenes.items():
        bench.write('scene.yaml', text)
        ask(bounded, what, ['check', 'scene.yaml'], {2})
    bench.write('chain.yaml', chain(2000))
    ask(bounded, 'a chain of 2,000', ['inspect', 'chain.yaml'], {0, 2})
    checkpoints(bench, ask, bounded)
    os.mkfifo(bench.folder / 'pipe')
    pendulum = 'scenes/pendulum.yaml'
    commands = [['run', 'pipe'], ['run', 'pipe', '--out', 'out'], ['eval', pendulum, '--state', 'pipe'],
                ['inverse', 'scenes/two-link-slew.yaml', '--motion', 'pipe']]
    for command in commands if share > 0.1 else commands[-1:]:
        ask(pipes, ' '.join(command), command, {2, 3}, 30)
    for device in ('/dev/zero', '/dev/full'):
        for command in (['run', device], ['eval', pendulum, '--state', device],
                        ['inverse', 'scenes/two-link-slew.yaml', '--motion', device]):
            ask(pipes, ' '.join(command), command, {2, 3})
    return [bounded, pipes]


def checkpoints(bench, ask, row):
    """Crafted ones: nested a million times, sizes that are lies, parts of other types under a right checksum."""
    import zlib

    def head(major, n):
        for bits, size in ((24, 1), (25, 2), (26, 4), (27, 8)):
            if n < (24 if bits == 24 and n < 24 else 256 ** size):
                return bytes([major << 5 | n]) if n < 24 else bytes([major << 5 | bits]) + n.to_bytes(size, 'big')
        raise ValueError(n)

    def text(s):
        return head(3, len(s)) + s.encode()

    def outer(content, name='withy-checkpoint/2'):
        return (head(5, 3) + text('format') + text(name) + text('crc32') + head(0, zlib.crc32(content)) + text('content') +
                head(2, len(content)) + content)
    deep = b'\x81' * 2_000_000
    crafted = {'nested': deep, 'nested within': outer(deep), 'a list without end': b'\x9b\0\0\0\xff\xff\xff\xff\xff',
               'a text without end': b'\x7b\0\0\0\xff\xff\xff\xff\xff', 'a list': outer(head(4, 0)), 'breaks': outer(b'\xff' * 2),
               'another format': head(5, 1) + text('format') + head(0, 5), 'empty': b'', 'a map': outer(head(5, 0)),
               'a wrong type': outer(head(5, 1) + text('run') + head(0, 3))}
    bench.run(['run', 'scenes/pendulum.yaml', '--out', 'out'])
    for what, content in crafted.items():
        bench.write('out/checkpoint.cbor', content)
        bench.write('out/checkpoint.previous.cbor', content)
        ask(row, f'checkpoint: {what}', ['run', 'scenes/pendulum.yaml', '--out', 'out', '--resume'], {2})
    bench.remove('out')
