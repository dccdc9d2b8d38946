#!/usr/bin/env python3
"""abi.py [--build DIR] [--cc CC] [--update [--unreleased]]: holds what hosts link against what is committed.

Two lists, each with the version it is of: bindings/c/abi.txt has the declarations of <withy/withy.h> as a compiler for C
sees them, and libwithy-c must show these functions and no others of its name; host/abi.txt has the functions of
withy::host that libwithy-host shows. What differs from its list is an error, and a name in a C example of docs/ that the
header does not have. --update writes the lists anew, but takes
nothing away unless the version of the project allows it (docs/versions.md); --unreleased: what goes was in no release.
"""

import argparse
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
SHORT = (("std::__cxx11::basic_string<char, std::char_traits<char>, std::allocator<char> >", "std::string"),
         ("std::basic_string_view<char, std::char_traits<char> >", "std::string_view"),
         (", 18446744073709551615ul>", ">"))


def output(*command):
    return subprocess.run([str(c) for c in command], check=True, text=True, stdout=subprocess.PIPE).stdout


def version():
    text = (ROOT / "CMakeLists.txt").read_text()
    return tuple(map(int, re.search(r"project\(withy VERSION (\d+)\.(\d+)", text).groups()))


def shown(library):
    """The functions and data of a library that are its own: not what headers bring along in every one."""
    for line in output("nm", "--dynamic", "--defined-only", library).splitlines():
        _, kind, name = line.split()
        if kind in "TDBR":
            yield name


def declarations(cc):
    """The top-level declarations of the header, one a line."""
    header = ROOT / "bindings/c/withy.h"
    text, inside = [], False
    for line in output(cc, "-x", "c", "-E", header).splitlines():
        if marker := re.match(r'# \d+ "(.*?)"', line):
            inside = marker.group(1) == str(header)
        elif inside:
            text.append(line)
    text = re.sub(r"__attribute__\(\(.*?\)\) ", "", " ".join(" ".join(text).split()))
    return [d.strip() + ";" for d in re.findall(r"((?:\{[^}]*\}|[^;{])+);", text)]


def interface_in_c(library, cc):
    declared = declarations(cc)
    functions = {m.group(1) for d in declared if (m := re.match(r"(?!typedef)[^(]*?\b(withy_\w+)\(", d))}
    exported = {name for name in shown(library) if name.startswith("withy_")}
    for name in sorted(functions ^ exported):
        sys.exit(f"{name} is {'declared, but not in' if name in functions else 'not declared, but in'} {library.name}")
    return declared


def unknown_in_pages(declared):
    """Names of withy in examples in C that are none of the header's, each with its page."""
    known = set(re.findall(r"\b(?:withy|WITHY)_\w+", " ".join(declared)))
    for page in sorted((ROOT / "docs").glob("*.md")):
        for example in re.findall(r"^```c$(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL):
            for name in re.findall(r"\b(?:withy|WITHY)_\w+", example):
                if name not in known and f"S_FUNCTION_NAME {name}" not in example:
                    yield f"{page.relative_to(ROOT)}: {name} is not in <withy/withy.h>"


def interface_in_cpp(library):
    names = subprocess.run(["c++filt"], input="\n".join(shown(library)), text=True, check=True, stdout=subprocess.PIPE).stdout
    for long, short in SHORT:
        names = names.replace(long, short)
    return sorted({n.replace("[abi:cxx11]", "") for n in names.splitlines() if n.startswith("withy::host::")})


def read(path):
    if not path.exists():
        return version(), []
    first, *lines = path.read_text().splitlines()
    return tuple(map(int, re.match(r"# (\d+)\.(\d+):", first).groups())), lines


def grown(old, now):
    """Whether a structure that says its size, or an enumeration, has only got members at its end."""
    if not old.startswith(("typedef enum", "typedef struct")) or ("struct" in old and "{ size_t size;" not in old):
        return False
    begin = old[:old.rindex(" }")]
    return any(n.startswith(begin) and n.endswith(old[old.rindex(" }"):]) for n in now)


def hold(path, now, options):
    """Whether the list is what there is; after --update it is, or the reason why not is printed."""
    since, listed = read(path)
    gone, new = [n for n in listed if n not in now], [n for n in now if n not in listed]
    # Before 1.0 a minor version may take away, from then on a major one only.
    compatible = version()[0] == since[0] and (since[0] > 0 or version()[1] == since[1])
    refused = compatible and not options.unreleased and not all(grown(n, now) for n in gone)
    if options.update and not refused:
        path.write_text("\n".join(["# {}.{}: written by scripts/abi.py --update".format(*version()), *now]) + "\n")
        return True
    for name in gone:
        print(f"{path.relative_to(ROOT)}: gone or changed: {name}")
    for name in new:
        print(f"{path.relative_to(ROOT)}: new: {name}")
    if refused:
        print(f"What {since[0]}.{since[1]} has cannot go without another version: docs/versions.md")
    elif new:
        print("What is new is kept by scripts/abi.py --update")
    return not gone and not new


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    parser.add_argument("--cc", default="cc")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--unreleased", action="store_true")
    options = parser.parse_args()
    libraries = options.build / "lib"
    in_c = interface_in_c(libraries / "libwithy-c.so", options.cc)
    wrong = list(unknown_in_pages(in_c))
    print("".join(line + "\n" for line in wrong), end="")
    held = [not wrong, hold(ROOT / "bindings/c/abi.txt", in_c, options),
            hold(ROOT / "host/abi.txt", interface_in_cpp(libraries / "libwithy-host.so"), options)]
    sys.exit(0 if all(held) else 1)


if __name__ == "__main__":
    main()
