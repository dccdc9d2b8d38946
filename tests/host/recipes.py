#!/usr/bin/env python3
"""recipes.py DOCS CC CXX INCLUDE...: compiles the examples of docs/recipes.md, as they stand there, against withy's headers.

What they take of their frameworks is declared in tests/host/frameworks. Every warning is an error, so that a name of
either side that is not there, or is called otherwise, is found.
"""

import pathlib
import re
import subprocess
import sys
import tempfile


def examples(text):
    """Title of its section, language, line and text of every block of C or C++."""
    title = ""
    for found in re.finditer(r"^## ([^\n]+)$|^```(c|cpp)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        if found[1]:
            title = found[1]
        else:
            yield title, found[2], text[:found.start(3)].count("\n") + 1, found[3]


def main():
    page = pathlib.Path(sys.argv[1]) / "recipes.md"
    cc, cxx, includes = sys.argv[2], sys.argv[3], sys.argv[4:]
    frameworks = pathlib.Path(__file__).parent / "frameworks"
    compiled = []
    with tempfile.TemporaryDirectory() as folder:
        for title, language, line, text in examples(page.read_text()):
            source = pathlib.Path(folder) / f"example.{language}"
            source.write_text(f'#line {line} "{page}"\n{text}')
            command = [cc, "-std=c99"] if language == "c" else [cxx, "-std=c++20"]
            command += ["-fsyntax-only", "-Wall", "-Wno-unused-function", "-Werror", f"-I{frameworks}",
                        *(f"-isystem{include}" for include in includes), str(source)]
            if subprocess.run(command, check=False).returncode != 0:
                sys.exit(f"{page}:{line}: the example of {title} does not compile")
            compiled.append(title)
    expected = ["Simulink", "42", "cFS", "Basilisk", "ROS 2 control"]
    if compiled != expected:
        sys.exit(f"{page}: compiled {compiled}; need {expected}")
    print("compiled:", ", ".join(compiled))


if __name__ == "__main__":
    main()
