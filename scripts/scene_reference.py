#!/usr/bin/env python3
"""scene_reference.py PROGRAM > PAGE: every part that a scene can name, with all its options, as the program knows them:
Markdown made from `PROGRAM plugins --json`. scripts/site.sh puts it into the site."""
import json
import subprocess
import sys

HEADS = {
    "body": ("Bodies", "under `bodies`, as `type`"), "hinge": ("Hinges", "under `hinges` and `constraints`, as `type`"),
    "load": ("Loads", "under `loads`, as `type`"), "motion": ("Motions", "under `motions`, as `type`"),
    "sensor": ("Outputs", "under `outputs`, as `type`"), "integrator": ("Integrators", "as `integrator`, or its `name`"),
    "formulation": ("Formulations", "as `formulation`, or its `name`"),
    "strain-kinematics": ("Strain kinematics", "as `kinematics` of a `formulation`"),
    "mode-family": ("Mode families", "as `family` of a strain of a body"),
}


def text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list):
        return "[" + ", ".join(text(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {text(v)}" for k, v in value.items()) + "}"
    return str(value)


def value_of(o):
    """What kind of value an option takes, with its unit and range."""
    kind, unit = o["kind"], o.get("unit", "")
    words = [f"{o['count']} numbers" if kind == "vector" and "count" in o else kind]
    if unit and unit != "1":
        words.append(f"[{unit}]")
    words += [f"{sign} {text(o[key])}" for key, sign in (("above", ">"), ("least", "≥"), ("most", "≤")) if key in o]
    if "columns" in o:
        rows = "rows [" + ", ".join(o["columns"]) + "]"
        words.append(rows if kind == "table" else f"or {rows}")
    if "choices" in o:
        words = ["one of " + ", ".join(f"`{c}`" for c in o["choices"])]
    return " ".join(words)


def rows(options, before=""):
    for o in options:
        need = "required" if o.get("required") else f"`{text(o['default'])}`" if "default" in o else ""
        yield f"| `{before}{o['key']}` | {value_of(o)} | {need} | {o['meaning']} |"
        if o["kind"] == "named maps":
            yield from rows(o["members"], before + o["key"] + ".NAME.")
        else:
            yield from rows(o.get("members", []), before + o["key"] + ".")


parts = json.loads(subprocess.run([sys.argv[1], "plugins", "--json"], check=True, capture_output=True, text=True).stdout)
print("# Scene reference\n")
print("Every part that a scene can name, with its options: made from the program's own registry, which also checks scenes, writes the JSON Schema of editors "
      "(`withy schema`) and answers `withy plugins NAME`. Dots go into a map: `bending_y.modes` is written `bending_y: {modes: 2}`. A number may have any unit of its "
      "kind, as `25 mm`; without one it is in the unit given here. What else a scene holds is in [its format](scene-format.md).")
for kind, (head, where) in HEADS.items():
    print(f"\n## {head}\n\nThey stand {where}.")
    for part in sorted((p for p in parts if p["kind"] == kind), key=lambda p: p["id"]):
        print(f"\n### {kind} `{part['id']}`\n\n{part['summary']}.\n")
        if part["options"]:
            print("| option | value | default | meaning |\n|---|---|---|---|")
            print("\n".join(rows(part["options"])))
        else:
            print("No options.")
