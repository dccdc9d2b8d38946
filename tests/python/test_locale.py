"""Numbers are read and written with a point, whatever the locale of the process."""

import pathlib
import shutil
import subprocess
import sys

import pytest

SCENES = pathlib.Path(__file__).parents[2] / "scenes"

# A locale of decimal commas that no package needs to be installed for.
COMMA = """comment_char %
escape_char /
LC_NUMERIC
decimal_point "<U002C>"
thousands_sep "<U002E>"
grouping 3;3
END LC_NUMERIC
"""

STUDIES = """
import json, locale, sys
import numpy, withy

if sys.argv[2] == "comma":
    locale.setlocale(locale.LC_NUMERIC, "comma")
    assert locale.localeconv()["decimal_point"] == ","


def told(what):  # but for CPU time, and which points of a trade it makes the cheapest
    if isinstance(what, dict):
        return {name: told(value) for name, value in what.items()
                if "seconds" not in name and name not in ("pareto", "cheapest")}
    if isinstance(what, (list, tuple)):
        return [told(value) for value in what]
    if isinstance(what, numpy.ndarray):
        return [str(what.shape), what.tobytes().hex()]
    return what


def tell(what):
    print(json.dumps(told(what)))


slew = withy.load(sys.argv[1] + "/two-link-slew.yaml").set("time.end", "0.25 s").set("loads.slew.time_scale", 1.05)
run = slew.run()
tell([run.summary, run.table, slew.to_yaml()])
tell(slew.modes(lock=["shoulder", "elbow"], damp=["1.5%", 0.02]))
tell(slew.modes(lock=["shoulder", "elbow"], sweep="bodies.link1.length=0.95:1.05:3"))
tell(slew.linearize(lock=["shoulder"], inputs=["elbow"], outputs=["link2.tip.y"]))
tell(slew.equilibrium(lock=["shoulder", "elbow"]))
tell(slew.compare(["ruthless", "quadratic"]))
tell(slew.trade(formulations=["ruthless"], modes=[1, 2], tolerances=[1e-4], integrators=["dopri5"]))
pendulum = withy.load(sys.argv[1] + "/pendulum.yaml")
tell(pendulum.tune({"bodies.rod.center_of_mass.1": ("-0.8 m", -0.25)}, sys.argv[1] + "/measured/pendulum.csv",
                   deviations={"pivot": "0.2 deg", "rod.tip.x": 0.0025}))
for path, value in (("gravity", "0.5 kg"), ("bodies.rod.mass", -0.5), ("time.end", "1,5 s")):
    try:
        pendulum.copy().set(path, value).check()
    except withy.SceneError as error:
        tell(str(error))
"""


@pytest.fixture
def comma(tmp_path):
    """A folder for LOCPATH with the locale `comma`."""
    if shutil.which("localedef") is None:
        pytest.skip("there is no localedef (Debian: libc-bin)")
    characters = "".join(f"<U{i:04X}> /x{i:02x} C\n" for i in range(128))
    (tmp_path / "ascii").write_text(
        f"<code_set_name> ANSI_X3.4-1968\n<comment_char> %\n<escape_char> /\nCHARMAP\n{characters}END CHARMAP\n")
    (tmp_path / "source").write_text(COMMA)
    # That other categories are not defined is a warning; with any the status is 1.
    subprocess.run(["localedef", "-c", "-i", "./source", "-f", "./ascii", "./comma"], cwd=tmp_path, capture_output=True,
                   check=False)
    assert (tmp_path / "comma" / "LC_NUMERIC").exists()
    return tmp_path


def test_studies_are_the_same_in_a_process_with_decimal_commas(comma, monkeypatch):
    monkeypatch.setenv("LOCPATH", str(comma))
    told = [subprocess.run([sys.executable, "-c", STUDIES, SCENES, which], capture_output=True, text=True, timeout=300,
                           check=True).stdout.splitlines() for which in ("point", "comma")]
    assert len(told[0]) == 11
    for with_points, with_commas in zip(*told, strict=True):
        assert with_commas == with_points
