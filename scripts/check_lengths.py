#!/usr/bin/env python3
"""check_lengths.py [--files N] [--functions N] [ROOT]: lists functions that are longer than a screen, N lines (60).

With --files also sources longer than N lines. Counts from the line of a function's name to its closing brace, tests and
bodies of lambdas in them included. `--self-test` counts one that it knows."""
import pathlib, re, subprocess, sys

# What hides braces: comments, raw and plain strings, characters, directives.
HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:\\\n|[^\n])*',
                    re.S | re.M)
SCOPE = re.compile(r'\b(?:namespace|class|struct|union|enum|extern)\b')


def functions(text):
    """(name, first line, number of lines) of the functions of a text, outermost ones."""
    text = HIDDEN.sub(lambda m: re.sub(r'[^\n]', ' ', m.group()), text)
    stack, begin, found = [], 0, []
    for match in re.finditer(r'[{};]', text):
        head = text[begin:match.start()]
        inside = any(kind == 'function' for kind, *_ in stack)
        begin = match.end()
        if match.group() == '{':
            kind = 'scope' if SCOPE.search(head) and '(' not in SCOPE.split(head)[0] else 'block'
            if kind == 'block' and '(' in head and not inside and '=' not in head.split('(')[0]:
                kind = 'function'
            name = re.search(r'([\w:~]+)\s*\((.*)', head, re.S)
            label = name.group(1) if name else ''
            if label in ('TEST', 'TEST_F', 'TEST_P', 'TYPED_TEST'):
                label += '(' + re.sub(r'\s+', ' ', name.group(2)).split(')')[0] + ')'
            first = text[:match.start() - len(head.lstrip())].count('\n') + 1
            stack.append((kind, label, first))
        elif match.group() == '}' and stack:
            kind, label, first = stack.pop()
            if kind == 'function':
                found.append((label, first, text[:match.start()].count('\n') + 2 - first))
    return found


def limit(name, otherwise):
    return int(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else otherwise


if '--self-test' in sys.argv:
    known = 'namespace a {\nstruct B : C {\n  int d(int e) const {\n    if (e) {\n      f({"}"});\n    }\n    return 1;  // }\n  }\n};\n}\n'
    assert functions(known) == [('d', 3, 6)], functions(known)
root = sys.argv[-1] if len(sys.argv) > 1 and pathlib.Path(sys.argv[-1]).is_dir() else pathlib.Path(__file__).parent.parent
files = subprocess.run(['git', '-C', root, 'ls-files', '--cached', '--others', '--exclude-standard', '*.cpp', '*.hpp'],
                       capture_output=True, text=True, check=True).stdout.split()
screen, sheet = limit('--functions', 60), limit('--files', None)
long = []
for name in files:
    text = (pathlib.Path(root) / name).read_text()
    long += [(lines, f'{name}:{first}: {label} has {lines} lines') for label, first, lines in functions(text) if lines > screen]
    if sheet and text.count('\n') > sheet:
        long.append((text.count('\n'), f'{name}: has {text.count(chr(10))} lines'))
for _, message in sorted(long, reverse=True):
    print(message)
sys.exit(1 if long else 0)
