#!/usr/bin/env python3
"""check_odr.py [ROOT]: finds types and inline functions of one qualified name that two files define.

The linker takes one of them for both, without a word, wherever two libraries meet in a program. Names in unnamed
namespaces and inside functions belong to their file and may repeat. Programs of different folders of tests never meet;
each meets the libraries. `--self-test` plants pairs and expects that exactly those are found."""
import collections, pathlib, re, subprocess, sys, tempfile

TOKEN = re.compile(r'[{};]|\b(?:namespace|class|struct|union|enum)\b')
HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:\\\n|[^\n])*',
                    re.S | re.M)
NAMESPACE = re.compile(r'(?:^|\s)(?:inline\s+)?namespace\s*([\w:]*)\s*$')
TYPE = re.compile(r'(?:^|[\s>])(?:class|struct|union|enum(?:\s+class|\s+struct)?)\s+(?:\[\[.*?\]\]\s*|alignas\([^)]*\)\s*)*'
                  r'(\w+(?:::\w+)*)(?:\s+final)?\s*(?::(?!:).*)?$', re.S)
INLINE = re.compile(r'\b(?:inline|constexpr|consteval)\b.*?([\w:~]+)\s*(\(.*\))[^()]*$', re.S)


def definitions(text):
    """Qualified names of the types and inline functions that a file shows to the linker."""
    text = HIDDEN.sub(' ', text)
    scopes, begin, found = [], 0, []  # a scope: its name, or None where what is inside belongs to the file
    for match in re.finditer(r'[{};]', text):
        head, begin_next = text[begin:match.start()].strip(), match.end()
        begin = begin_next
        if match.group() == ';':
            continue
        if match.group() == '}':
            if scopes:
                scopes.pop()
            continue
        namespace, of_type = NAMESPACE.search(head), TYPE.search(head)
        visible = None not in scopes
        if namespace:
            scopes.append(namespace.group(1) or None)
        elif of_type and '(' not in head.split(of_type.group(1))[0].replace('alignas(', ''):
            name = '::'.join([s for s in scopes if s] + [of_type.group(1)])
            if visible and '>' not in head[of_type.end(1):].split(':')[0]:
                found.append('type ' + name)
            scopes.append(of_type.group(1))
        else:
            function = INLINE.search(head)
            if visible and function and 'template' not in head and 'operator' not in head and scopes:
                parameters = re.sub(r'\s+', ' ', function.group(2))
                found.append('function ' + '::'.join(scopes + [function.group(1)]) + parameters)
            scopes.append(None)
    return found


def meet(a, b):
    """Whether what two files define may come together in one program."""
    tests = [p for p in (a, b) if p.startswith('tests/')]
    apart = ('tests/out_of_tree/', 'tests/plugins/zoo/', 'tests/bench/')
    if any(p.startswith(apart) for p in tests):
        return False
    return len(tests) < 2 or a.split('/')[1] == b.split('/')[1] or 'conformance' in (a.split('/')[1], b.split('/')[1])


def pairs(root, files):
    places = collections.defaultdict(list)
    for file in files:
        for name in set(definitions((root / file).read_text(encoding='utf-8'))):
            places[name].append(file)
    return [(name, a, b) for name, where in sorted(places.items()) for i, a in enumerate(where) for b in where[i + 1:]
            if meet(a, b)]


def self_test():
    files = {
        'core/a.hpp': 'namespace withy { struct Tree { int a; }; inline int f(int x) { return x; } }',
        'scene/a.cpp': 'namespace withy {\nclass Tree final : public Base {};  // another\nnamespace { struct Own {}; } '
                       'inline int f(int  x) { struct Local {}; return 2 * x; } }',
        'loads/a.cpp': 'namespace withy { namespace { struct Tree {}; struct Own {}; } inline int f(double x); '
                       'namespace sweep { struct Tree {}; } struct Tree; void g() { struct Local {}; } }',
        'tests/a/a.cpp': 'namespace withy { struct Help {}; template <> struct Traits<Tree> {}; }',
        'tests/b/a.cpp': 'namespace withy { struct Help {}; template <> struct Traits<Help> {}; }',
        'host/a.cpp': 'template <> class far::detail::caster<A> : public Base<A> {};',
        'host/b.cpp': 'template <> class far::detail::caster<B> : public Base<B> {};',
    }
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding='utf-8')
        found = [(n, {a, b}) for n, a, b in pairs(root, files)]
    both = {'core/a.hpp', 'scene/a.cpp'}
    expected = [('function withy::f(int x)', both), ('type withy::Tree', both)]
    if found != expected:
        sys.exit(f'check_odr: expected {expected}, found {found}')
    print('check_odr: finds what is planted, and nothing else')


if __name__ == '__main__':
    if '--self-test' in sys.argv:
        self_test()
        sys.exit()
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    files = subprocess.run(['git', 'ls-files', '--cached', '--others', '--exclude-standard', '*.hpp', '*.cpp'], cwd=root,
                           check=True, capture_output=True, text=True).stdout.split()
    wrong = pairs(root, [f for f in files if (root / f).is_file()])
    for name, a, b in wrong:
        print(f'{a}, {b}: both define {name}')
    print(f'check_odr: {len(wrong)} names defined twice in {len(files)} files')
    sys.exit(1 if wrong else 0)
