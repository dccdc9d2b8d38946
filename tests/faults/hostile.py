"""Plugins that throw, exit, return nothing or round otherwise in any call; libraries that are none, or not ours."""
import os
import pathlib
import shutil

from common import Row

SCENE = '''format: withy/1
gravity: [0, -9.81, 0]
time: {{end: 0.2, output: 0.05}}
integrator: {{name: {integrator}}}
bodies:
  b: {{type: rigid, mass: 1, center_of_mass: [1, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}
  e: {{type: hostile, what: "{what}"}}
hinges:
  h: {{type: revolute, axis: [0, 0, 1], parent: world, child: b}}
  w: {{type: revolute, axis: [0, 0, 1], parent: world, child: e}}
loads:
  l: {{type: hostile-load, what: "{what}"}}
'''
CALLS = ('make', 'shape', 'station', 'stations', 'remarks', 'load', 'bind', 'begin', 'add', 'late', 'discontinuities', 'end')
DEEDS = ('throws', 'number', 'memory', 'exit', 'quick', 'round', 'flush')
THROWN = ('throws', 'number', 'memory')
READ = ('make', 'shape', 'station', 'stations', 'load', 'bind', 'begin', 'discontinuities', 'end')  # with the scene
SPECIAL = ('make-null', 'load-null', 'bind-null', 'station-none', 'station-nan', 'add-nan', 'discontinuities-nan',
           'end-nan', 'begin-nan')


def hostile(bench, share):
    if not bench.zoo:
        return []
    rows = [Row('plugin', 'throws, exits, or changes arithmetic in any call'), Row('plugin', 'returns nothing, or no number'),
            Row('plugin', 'library cut short, no file, or of another user')]
    command = ['run', 'scene.yaml', '--out', 'out', '--plugins', bench.zoo]

    def run(what, integrator='dopri5', environment=None):
        bench.remove('out')
        bench.write('scene.yaml', SCENE.format(what=what, integrator=integrator))
        return bench.run(command, seconds=60, environment=environment)

    if why := run('nothing').fault({0}):
        rows[0].note('a plugin that does nothing', why)
        return rows
    good = bench.read('out/results.csv')
    deeds = [(c, d) for c in CALLS for d in DEEDS]
    always = [('station', 'throws'), ('make', 'round'), ('add', 'round'), ('late', 'round'), ('bind', 'exit'),
              ('bind', 'number'), ('add', 'number')]
    for call, deed in deeds if share > 0.1 else always + bench.random.sample(deeds, 6):
        what = f'{call}-{deed}'
        ended = run(what)
        # What is never asked for is never done; what is thrown while a scene is read is reported at its place.
        allowed = {0, 2} if deed in ('throws', 'number') and call in READ else {0, 2, 3} if deed in THROWN else {0, 3}
        why = ended.fault(allowed, most_lines=3)
        if not why and ended.status == 0 and bench.read('out/results.csv') != good:
            why = 'other results, and not a word'
        rows[0].note(what, why)
    for deed in DEEDS:
        if deed in ('throws', 'number', 'exit', 'round'):
            ended = run('nothing', environment={'WITHY_HOSTILE': f'enroll-{deed}'})
            rows[0].note(f'enroll-{deed}', ended.fault({3}, most_lines=2))
    for what in SPECIAL:
        for integrator in ('dopri5', 'imex'):
            rows[1].note(f'{what}, {integrator}', run(what, integrator).fault({1, 2, 3}, most_lines=4))
    libraries(bench, share, rows[2], command)
    return rows


def libraries(bench, share, row, command):
    bench.write('scene.yaml', SCENE.format(what='', integrator='dopri5'))
    copy = bench.folder / 'plugins'
    shutil.copytree(bench.zoo, copy)
    library = copy / 'hostile.so'
    content = library.read_bytes()
    command = command[:-1] + ['plugins']

    def refused(what, allowed=frozenset({3})):
        bench.remove('out')
        row.note(what, bench.run(command, seconds=30).fault(allowed, most_lines=2))
    refused('as it is', {0})
    for _ in range(max(3, round(30 * share))):
        size = bench.random.randrange(len(content))
        library.write_bytes(content[:size])
        # Behind what is mapped there are only names for debuggers.
        refused(f'{size} bytes of {len(content)}', {0, 3})
    library.unlink()
    os.mkfifo(library)
    refused('a pipe')
    library.unlink()
    library.mkdir()
    refused('a folder')
    library.rmdir()
    library.write_bytes(content)
    manifest = copy / 'hostile.plugin'
    text = manifest.read_bytes()
    manifest.unlink()
    os.mkfifo(manifest)
    refused('a pipe as manifest')
    manifest.unlink()
    manifest.write_bytes(text)
    if os.geteuid() == 0:
        for place in (library, manifest, copy):
            os.chown(place, 4711, 4711)
            refused(f'{pathlib.Path(place).name} of another user')
            os.chown(place, 0, 0)
            os.chown(place, 0, 4711)
            place.chmod(place.stat().st_mode | 0o020)
            refused(f'{place.name} that a group may write')
            os.chown(place, 0, 0)
            place.chmod(place.stat().st_mode & ~0o020)
    library.chmod(0o777)
    refused('a library that everybody may write')
    library.chmod(0o755)
    refused('as it was', {0})
