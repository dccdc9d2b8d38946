#!/usr/bin/env python3
"""typed_numbers.py [--self-test]: finds measured numbers that somebody typed by hand into README.md and the pages of docs/.

A number counts as measured where one of these stands behind it, or behind the list or range that it begins ("14 to
15 mm"): a unit of time (ns to h), a length (nm to m), rad/s, Hz, rpm, N, an angle (°, deg), memory (kB to GB), %, times, ×; a count of cases ("22 of
24"); and where it fills a cell of a table and has a decimal point or an exponent. Looked at is what a person writes:
not blocks that commands write (<!-- measured, source, table … -->), not code, nor words in `backquotes`.

Such a number passes where
* it is read off a measurement: a block of the same page has it with that unit, rounded as the text rounds it, so that a table measured anew
  is at odds with what the text says of it; or
* docs/facts.txt lists it as a fact with a reason. An entry that no page needs, or whose reason does not hold, is an
  error too.

A line of docs/facts.txt: page, words of the page with the numbers, reason, with tabs between. Reasons:
  definition WHY        a number that the sentence itself sets: an accuracy asked, a scene's input, a unit, a quantile
  closed form WHY       it follows from a formula that stands there
  literature WHO        published by others
  source FILE: WORDS    a constant of the program or a scene, or what a test asserts: the file has these words
  measured NAME         docs/measured/NAME.txt has all numbers of these words, rounded so"""
import pathlib
import re
import sys

top = pathlib.Path(__file__).resolve().parents[1]

of_unit = {"ns": ("s", 1e-9), "µs": ("s", 1e-6), "ms": ("s", 1e-3), "s": ("s", 1.0), "min": ("s", 60.0), "h": ("s", 3600.0),
           "nm": ("m", 1e-9), "µm": ("m", 1e-6), "mm": ("m", 1e-3), "m": ("m", 1.0),
           "rad/s": ("rad/s", 1.0), "Hz": ("Hz", 1.0), "rpm": ("rpm", 1.0), "N": ("N", 1.0), "°": ("°", 1.0), "deg": ("°", 1.0),
           "kB": ("B", 1e3), "MB": ("B", 1e6), "GB": ("B", 1e9), "%": ("%", 1.0), "times": ("", 1.0), "×": ("", 1.0), "": ("", 1.0)}
figure = r"(?<![\w.,^/])[-−]?\d[\d,]*(?:\.\d+)?(?:[eE][-−+]?\d{1,2})?(?![\d.]*\d)"
units = r"(?:ns|µs|ms|s|min|h|nm|µm|mm|m|rad/s|Hz|rpm|N|deg|kB|MB|GB|times)(?![\w/²³^·])|°|%|×(?! ?\d)"
between = r"(?:,? (?:to|and|or|over) |, |–|; )"
claim = re.compile(rf"({figure}(?:{between}{figure})*)(?: |\u00a0)?({units})")
count = re.compile(r"(?<![\w.])(\d+) of (?:the |all )?(\d+)(?![\w.]\d)")
lone = re.compile(rf"^\W*({figure})\W*$")
block_begins = re.compile(r"^<!-- (?:measured|source|table|ablation|courses|treatments)\b.* -->$")


def value(text):
    """A figure and half of what its last digit is worth."""
    plain = text.replace(",", "").replace("−", "-")
    mantissa, _, power = plain.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    return float(plain), 0.5 * 10.0 ** (int(power or 0) - digits)


def claims(line, in_table):
    """Figures of a line that count as measured: pairs of text and unit."""
    found = []
    for m in claim.finditer(line):
        found += [(f, m[2]) for f in re.findall(figure, m[1])]
    for m in count.finditer(line):
        found.append((m[1], f"of {m[2]}"))
    if in_table:
        for cell in line.strip().strip("|").split("|"):
            m = lone.match(cell.strip())
            if m and re.search(r"[.eE]", m[1]):
                found.append((m[1], ""))
    return found


def lines_of(page):
    """Lines that a person writes: number, text, whether in a table; and those of blocks that commands write."""
    written, made = [], []
    fenced = generated = False
    for number, line in enumerate(page.split("\n"), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif block_begins.match(line):
            generated = True
        elif line == "<!-- end -->" or re.match(r"^<!-- end ", line):
            generated = False
        elif generated:
            if not line.startswith("<sub>"):
                made.append(line)
        elif not fenced and not line.startswith("    "):
            written.append((number, re.sub(r"`[^`]*`|\]\([^)]*\)|<!--.*?-->", " ", line), line.lstrip().startswith("|")))
    return written, made


def measured_values(made):
    """What commands wrote, as pairs of value in base units and dimension."""
    values, heads = set(), []
    for line in made:
        cells = [c.strip() for c in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            heads = []
        elif not heads:
            heads = cells
        for i, cell in enumerate(cells):
            unit = re.search(r"\[(.+?)\]|^(\S+)$", heads[i] if i < len(heads) else "")
            unit = (unit[1] or unit[2]) if unit else ""
            dimension, scale = of_unit.get(unit, ("", 1.0))
            for f in re.findall(figure, cell):
                values.add((value(f)[0] * scale, dimension))
        for m in claim.finditer(line):
            dimension, scale = of_unit[m[2]]
            values.update((value(f)[0] * scale, dimension) for f in re.findall(figure, m[1]))
        values.update((float(m[1]), f"of {m[2]}") for m in count.finditer(line))
    return values


def read_off(figure_text, unit, values):
    v, half = value(figure_text)
    dimension, scale = of_unit.get(unit, (unit, 1.0))
    return any(d == dimension and abs(abs(v) * scale - abs(m)) <= half * scale * (1 + 1e-9) for m, d in values)


def holds(reason, words):
    """Why a reason does not hold; empty where it does."""
    kind, _, rest = reason.partition(" ")
    if kind in ("definition", "literature") or reason.startswith("closed form "):
        return "" if len(rest.split()) >= 2 or kind == "literature" and rest else "a reason of a few words is wanted"
    if kind == "source":
        file, _, text = rest.partition(": ")
        return "" if text and (top / file).is_file() and text in (top / file).read_text() else f"{file} does not have “{text}”"
    if kind == "measured":
        file = top / f"docs/measured/{rest}.txt"
        if not file.is_file():
            return f"there is no {file.relative_to(top)}"
        values = measured_values(table_of(file))
        missing = [f"{f} {u}" for f, u in claims(words, False) if not read_off(f, u, values)]
        return f"{file.relative_to(top)} does not have {', '.join(missing)}" if missing else ""
    return "a reason is definition, closed form, literature, source or measured"


def table_of(file):
    _, _, body = file.read_text().partition("\n\n")
    return ["| " + " | ".join(l.split("\t")) + " |" if "\t" in l else l for l in body.split("\n")]


def read_facts(text):
    facts = []
    for number, line in enumerate(text.split("\n"), 1):
        if line and not line.startswith("#"):
            facts.append((number, *(line.split("\t") + ["", ""])[:3]))
    return facts


def check(pages, facts):
    """Faults of pages (name to text) beside facts, as sentences."""
    faults, needed = [], set()
    for name, text in pages.items():
        written, made = lines_of(text)
        values = measured_values(made)
        mine = [f for f in facts if f[1] == name]
        raw = text.split("\n")
        for number, line, in_table in written:
            found = claims(line, in_table)
            here = [f for f in mine if f[2] and f[2] in raw[number - 1]]
            for f, unit in found:
                if read_off(f, unit, values):
                    continue
                covering = [x for x in here if f in re.findall(figure, x[2])]
                needed.update(x[0] for x in covering)
                if not covering:
                    faults.append(f"{name}:{number}: {f} {unit}".rstrip() + " was typed by hand: let a command measure it (docs/measured), or give its reason in docs/facts.txt")
    for number, page, words, reason in facts:
        if number not in needed:
            faults.append(f"docs/facts.txt:{number}: no number of {page} needs this")
        elif why := holds(reason, words):
            faults.append(f"docs/facts.txt:{number}: {why}")
    return faults


def self_test():
    block = "<!-- measured: x -->\n| scene | tip error [mm] | CPU [ms] |\n|---|---|---|\n| arm | 14.3 | 0.785 |\n\n7 of 9 held.\n<!-- end -->\n"
    planted = {"The arm is 14.4 mm off.": 1, "It takes 2 to 3 times as long.": 2, "Held in 8 of 9.": 1, "| a | 0.125 |": 1, "Off by 1.5 %.": 1,
               "The arm is 14.3 mm off, or 14 mm.": 0, "It takes 0.79 ms.": 0, "Held in 7 of 9.": 0, "`sleep 3 s`": 0, "At 3 rad/s.": 1, "At 3 rad/s².": 0,
               "| a | 0.785 |": 1, "It is 14.3 ms off.": 1}
    for sentence, wanted in planted.items():
        found = check({"page.md": block + sentence}, [])
        assert len(found) == wanted, (sentence, found)
    fact = (1, "page.md", "Off by 1.5 %", "definition what is asked")
    assert not check({"page.md": "Off by 1.5 %."}, [fact])
    assert len(check({"page.md": "Off by 1.6 %."}, [fact])) == 2, "a number that has changed, and an entry that nothing needs"
    assert check({"page.md": "Off by 1.5 %."}, [(*fact[:3], "source scripts/typed_numbers.py: words that are" + " not there")])
    assert not check({"page.md": "Off by 1.5 %."}, [(*fact[:3], "source scripts/typed_numbers.py: def self_test")])
    assert check({"page.md": "Off by 1.5 %."}, [(*fact[:3], "so")])


def main():
    if sys.argv[1:] not in ([], ["--self-test"]):
        sys.exit("usage: scripts/typed_numbers.py [--self-test]")
    self_test()
    if sys.argv[1:]:
        return
    pages = {str(p.relative_to(top)): p.read_text() for p in [top / "README.md", *sorted((top / "docs").glob("*.md"))]}
    faults = check(pages, read_facts((top / "docs/facts.txt").read_text()))
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)


main()
