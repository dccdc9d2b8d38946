"""What scripts that measure tables of docs/ share: the program they call, and files of docs/measured."""
import datetime
import json
import pathlib
import subprocess
import sys

top = pathlib.Path(__file__).resolve().parents[1]


class Program:
    """The command line, build/release/bin/withy or the first of the words given."""

    def __init__(self, words=()):
        self.path = words[0] if words else "build/release/bin/withy"

    def run(self, *words, status=(0, 1)):
        """What a command prints. Ends this script where its status is none of these."""
        done = subprocess.run([self.path, *map(str, words)], cwd=top, capture_output=True, text=True)
        if done.returncode not in status:
            sys.exit(f"withy {' '.join(map(str, words))}: {done.stderr}")
        return done.stdout

    def told(self, *words, status=(0, 1)):
        return json.loads(self.run(*words, "--json", status=status))

    def frequencies(self, *words):
        """Of the vibrations, in order [rad/s]."""
        modes = self.told("modes", *words)["runs"][0]["points"][0]["modes"]
        return sorted(m["frequency"] for m in modes if m["frequency"] > 1e-9)


def record(name, command, rows, sentence="", machine=False):
    """Writes docs/measured/NAME.txt. `machine`: the processor is named, for times."""
    def git(*words):
        return subprocess.run(["git", *words], cwd=top, capture_output=True, text=True)
    commit = git("rev-parse", "--short", "HEAD").stdout.strip()
    if git("diff", "--quiet", "HEAD", "--", ":!docs").returncode:
        commit += " with changes"
    head = [f"command: {command}", f"commit: {commit}"]
    if machine:
        models = [line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
        head.append(f"machine: {models[0] if models else 'unknown'}")
    head.append(f"date: {datetime.date.today()}")
    body = "\n".join("\t".join(map(str, r)) for r in rows)
    text = "\n".join(head) + "\n\n" + (body + "\n" if rows else "") + (f"\n{sentence}\n" if sentence else "")
    (top / f"docs/measured/{name}.txt").write_text(text)
    print(name)
