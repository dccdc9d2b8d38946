#!/usr/bin/env python3
"""check_symbolic.py [FOLDER]: finds data that change among what libraries show that are linked with -Bsymbolic.

Such a library uses its own definition of what it shows, and others may use another of the same name: of functions, virtual
tables, type information (which is compared by name) and constants that is the same, of a variable it is another variable.
FOLDER: of the libraries, build/release/lib. `--self-test` links two libraries and expects that one is found."""
import pathlib, re, subprocess, sys, tempfile

# By the beginnings of their names: what may differ between libraries.
ALLOWED = ('boost::',  # tables and caches, made at their first use, the same everywhere
           'withy::campaign::keys::',  # constants that are made as the library is loaded
           'std::__detail::__waiter_pool_base::')  # of libwithy-sweeps, in which all are that wait for each other


def read(*words):
    return subprocess.run(['readelf', '-W', *map(str, words)], capture_output=True, text=True, check=True).stdout


def variables(library):
    """Names of the variables that a library shows; constants whose addresses are filled in by the loader are none."""
    changing = set()
    for line in read('-S', library).splitlines():
        section = re.match(r'\s*\[\s*(\d+)\]\s+(\S+)\s+\S+(?:\s+[0-9a-f]+){4}\s+(\w*)\s', line)
        if section and 'W' in section[3] and not section[2].startswith(('.data.rel.ro', '.init_array', '.fini_array', '.got')):
            changing.add(section[1])
    symbols = (line.split(None, 7) for line in read('--dyn-syms', '--demangle', library).splitlines())
    names = {s[7].split('@')[0].removeprefix('guard variable for ') for s in symbols
             if len(s) > 7 and s[3] in ('OBJECT', 'TLS') and s[5] in ('DEFAULT', 'PROTECTED') and s[6] in changing}
    return sorted(n for n in names if not n.startswith(ALLOWED))


def symbolic(folder):
    files = sorted(f for f in folder.glob('*.so') if f.is_file())
    return [f for f in files if '(SYMBOLIC)' in read('-d', f)]


def self_test():
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        for name, text in (('constant', 'struct A { virtual ~A(); }; A::~A() {} extern const int* const c; const int* const c = new int;'
                                        'extern const char* const t[1]; const char* const t[1] = {"a"}; static int own; int* f() { return &own; }'),
                           ('variable', 'int shown = 1; template <class T> struct B { static inline int of_all; }; int g() { return ++B<int>::of_all; }')):
            (folder / f'{name}.cpp').write_text(text)
            subprocess.run(['g++', '-shared', '-fPIC', '-Wl,-Bsymbolic', '-o', folder / f'lib{name}.so', folder / f'{name}.cpp'], check=True)
        found = {f.name: variables(f) for f in symbolic(folder)}
    # A constant that is computed as the library is loaded stays where it can be written.
    if found != {'libconstant.so': ['c'], 'libvariable.so': ['B<int>::of_all', 'shown']}:
        sys.exit(f'check_symbolic.py: the self-test found {found}')


if sys.argv[1:] == ['--self-test']:
    self_test()
else:
    libraries = symbolic(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else 'build/release/lib'))
    faults = [f'{f.name} shows a variable, {name}: give others a function that returns it' for f in libraries for name in variables(f)]
    if not libraries:
        faults = ['no library here is linked with -Bsymbolic']
    sys.exit('\n'.join(faults) or print(f'{len(libraries)} libraries show functions and constants alone'))
