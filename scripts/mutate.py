#!/usr/bin/env python3
"""Plants faults in the physics, one at a time, and reports which of them the tests find.

  scripts/mutate.py                      # all faults of scripts/mutants.tsv, a table in build/mutants/report.tsv
  scripts/mutate.py --only coriolis      # those whose name has this in it
  scripts/mutate.py --within loads,modes # those that the list gives to no other test programs
  scripts/mutate.py --named-only         # run the test programs that the list names and no others
  scripts/mutate.py --survivors          # run those again that survived
  scripts/mutate.py --write FILE         # run none; the table of the report goes into this document, between its marks
  scripts/mutate.py --check              # only that every fault still finds its place in the sources

Each fault is applied to a copy of the last commit, in build/mutants, built as the release is but for the sweeps, which are
not compiled a second time for AVX2. The test programs that the list names for it are run first, then all others; the first that fails has killed it. Faults that do not
compile count as none. Faults already in the report are not run again, so that a run that was stopped goes on.
"""
import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

root = Path(__file__).resolve().parent.parent
work = root / "build" / "mutants"
# The build lies in the copy as the release does in the tree, so that ccache knows what is not changed.
source, build, report = work / "source", work / "source" / "build" / "release", work / "report.tsv"
# In the order of their running time: what is quick may kill before what is thorough.
programs = ["simulation", "formulations", "integrators", "plugins", "validity", "bodies", "loads", "reference", "modes",
            "dynamics", "analysis"]
# Fails in the copy, whose sweeps know one instruction set.
not_here = "InstructionSet.*"


def read_mutants():
    """name, file, text, text in its place, test programs: columns of the list; \\n stands for a line's end."""
    mutants = []
    for number, line in enumerate((root / "scripts" / "mutants.tsv").read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        fields = line.split("\t")
        if len(fields) != 5:
            sys.exit(f"scripts/mutants.tsv:{number}: {len(fields)} columns; need 5")
        name, file, old, new, tests = fields
        text = (root / file).read_text()
        old, new = old.replace("\\n", "\n"), new.replace("\\n", "\n")
        if text.count(old) != 1:
            sys.exit(f"scripts/mutants.tsv:{number}: '{old}' is {text.count(old)} times in {file}; need once")
        mutants.append((name, file, old, new, tests.split(",")))
    return mutants


def command(arguments, **options):
    return subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def prepare(mutants):
    source.mkdir(parents=True, exist_ok=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=root, stdout=subprocess.PIPE, check=True).stdout
    subprocess.run(["tar", "x", "-C", str(source)], input=archive, check=True)
    for _, file, *_ in mutants:  # a fault left by a run that was stopped is younger than its source
        (source / file).touch()
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if command(["which", "ccache"]).returncode == 0 else []
    # As the release, so that ccache has what is not changed; the sweeps for one instruction set alone.
    configured = command(["cmake", "-S", str(source), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                          "-DWITHY_BENCH=OFF", "-DWITHY_KNOWS_X86_64_V3=OFF",
                          "-DWITHY_TEST_ROOMS=bodies;loads;dynamics;analysis;simulation;integrators;plugins;reference;study;campaign",
                          *launcher])
    if configured.returncode != 0:
        sys.exit(configured.stdout)


def compile_tests(tests, jobs):
    return command(["cmake", "--build", str(build), "-j", str(jobs), "--target", *[f"test-{t}" for t in tests]])


def first_failure(tests, jobs, limit):
    """The program that fails, or None; '' where it does not compile."""
    built = compile_tests(tests, jobs)
    if built.returncode != 0:
        return ""
    for test in tests:
        try:
            run = command([str(build / "bin" / f"test-{test}"), "--gtest_brief=1", "--gtest_fail_fast",
                           f"--gtest_filter=-{not_here}"], cwd=build, timeout=limit)
        except subprocess.TimeoutExpired:
            return f"{test} (hangs)"
        if run.returncode != 0:
            lines = [l for l in run.stdout.splitlines() if l.startswith("[  FAILED  ]")]
            return f"{test}: {lines[0][13:].split(' (')[0].split(', where')[0]}" if lines else test
    return None


def write_table(document, mutants, lines):
    """Puts the table between the two marks of the document."""
    rows = ["| fault | in | verdict | found by |", "|---|---|---|---|"]
    for name, file, *_ in mutants:
        if name in lines:
            _, verdict, killer, _ = lines[name]
            rows.append(f"| {name} | `{file}` | {verdict} | {f'`{killer}`' if killer else ''} |")
    verdicts = [lines[m[0]][1] for m in mutants if m[0] in lines]
    killed, survived = verdicts.count("killed"), verdicts.count("survived")
    rows += ["", f"{len(mutants)} faults, {len(verdicts)} run: {killed} killed, {survived} survived; "
                 f"{100 * killed / max(1, killed + survived):.1f} % killed."]
    text = document.read_text()
    first, last = "<!-- table of the faults: begin -->\n", "<!-- table of the faults: end -->"
    head, rest = text.split(first)
    document.write_text(head + first + "\n" + "\n".join(rows) + "\n\n" + last + rest.split(last)[1])


def read_report():
    """The last line of each fault; a fault that has survived and is found by a new test has two."""
    if not report.exists():
        return {}
    return {l.split("\t")[0]: l.split("\t") for l in report.read_text().splitlines()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="faults whose name has this in it")
    parser.add_argument("--within", help="faults that the list gives to these test programs alone, as loads,modes")
    parser.add_argument("--check", action="store_true", help="only check that every fault finds its place")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--named-only", action="store_true", help="run only the test programs the list names")
    parser.add_argument("--survivors", action="store_true", help="run again those that survived")
    parser.add_argument("--write", type=Path, help="write the report's table into this document and run nothing")
    parser.add_argument("--limit", type=float, default=900, help="seconds a test program may take")
    arguments = parser.parse_args()
    mutants = read_mutants()
    if arguments.within:
        mutants = [m for m in mutants if set(m[4]) <= set(arguments.within.split(","))]
    if arguments.check:
        print(f"{len(mutants)} faults find their places")
        return 0
    if arguments.write:
        write_table(arguments.write, mutants, read_report())
        return 0
    prepare(mutants)
    # No more than is run.
    needed = {t for m in mutants if arguments.only in m[0] for t in m[4]} if arguments.named_only else set(programs)
    base = compile_tests(sorted(needed), arguments.jobs)
    if base.returncode != 0:
        sys.exit(base.stdout)
    # A program that fails without a fault would kill every one of them.
    healthy = first_failure(sorted(needed, key=lambda p: (programs + [p]).index(p)), arguments.jobs, arguments.limit)
    if healthy is not None:
        sys.exit(f"the tests fail without any fault: {healthy}")
    done = {name: line[1] for name, line in read_report().items()}
    if arguments.survivors:
        done = {name: verdict for name, verdict in done.items() if verdict != "survived"}
    for name, file, old, new, tests in mutants:
        if arguments.only not in name or name in done:
            continue
        began = time.time()
        path = source / file
        text = path.read_text()
        path.write_text(text.replace(old, new))
        try:
            killer = first_failure(tests, arguments.jobs, arguments.limit)
            if killer is None and not arguments.named_only:
                killer = first_failure([p for p in programs if p not in tests], arguments.jobs, arguments.limit)
        finally:
            path.write_text(text)
        verdict = "survived" if killer is None else "does not compile" if killer == "" else "killed"
        done[name] = verdict
        with report.open("a") as out:
            out.write(f"{name}\t{verdict}\t{killer or ''}\t{time.time() - began:.0f} s\n")
        print(f"{verdict:<10} {name}: {killer or ''} ({time.time() - began:.0f} s)", flush=True)
    verdicts = [done[m[0]] for m in mutants if m[0] in done]
    killed, survived = verdicts.count("killed"), verdicts.count("survived")
    print(f"{len(mutants)} faults, {len(verdicts)} run: {killed} killed, {survived} survived, "
          f"{verdicts.count('does not compile')} do not compile; {100 * killed / max(1, killed + survived):.1f} % killed")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
