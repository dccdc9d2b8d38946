"""Scenes that are built in code, from functions that the plugins' own parameters make."""

import copy
import importlib.util
import inspect
import os
import pathlib
import pickle
import re
import subprocess
import sys
import textwrap

import numpy
import pytest

import withy

SCENES = pathlib.Path(__file__).parents[2] / "scenes"


def boom_on_a_bus():
    scene = withy.Scene(name="boom on a bus", time={"end": 1, "output": 0.1})
    scene.bodies["bus"] = withy.rigid(mass=100, inertia=numpy.diag([20.0, 20.0, 20.0])[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
    scene.bodies["boom"] = withy.beam(length="8 m", mass_per_length=0.4, bending_y={"stiffness": 2e3, "modes": 2})
    scene.hinges["axle"] = withy.revolute(axis=(0, 0, 1), parent="world", child="bus")
    scene.hinges["root"] = withy.weld(parent="bus", child="boom")
    scene.loads["command"] = withy.input(hinge="axle")
    scene.outputs["tip"] = withy.frame(of="boom.tip")
    return scene


# The same by hand.
TEXT = """
format: withy/1
time: {end: 1, output: 0.1}
bodies:
  bus: {type: rigid, mass: 100, inertia: [20, 20, 20, 0, 0, 0]}
  boom: {type: beam, length: 8, mass_per_length: 0.4, bending_y: {stiffness: 2000, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: bus}
  root: {type: weld, parent: bus, child: boom}
loads: {command: {type: input, hinge: axle}}
outputs: {tip: {type: frame, of: boom.tip}}
initial: {inputs: {command: 3}}
"""


def test_a_scene_in_code_is_the_scene_as_a_file_has_it(tmp_path):
    expected = withy.loads(TEXT).run().table
    scene = boom_on_a_bus().set("initial.inputs.command", 3)
    assert numpy.array_equal(scene.run().table, expected)
    file = tmp_path / "boom.yaml"
    file.write_text(scene.to_yaml())
    for again in (withy.load(file), pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert numpy.array_equal(again.run().table, expected)
        assert withy.loads(again.to_yaml()).to_yaml() == scene.to_yaml()


@pytest.mark.parametrize("file", sorted(SCENES.glob("*.yaml")), ids=lambda f: f.stem)
def test_what_a_scene_says_is_a_scene_again(file):
    first = withy.load(file).to_yaml()
    again = withy.loads(first, str(file))
    assert again.to_yaml() == first
    again.check()


def test_parts_are_taken_changed_and_given_back():
    scene = withy.loads(TEXT, "bus.yaml")
    assert list(scene.bodies) == ["bus", "boom"] and scene.bodies["boom"]["bending_y"]["modes"] == 2
    with pytest.raises(TypeError):  # a change of what was only looked at would be lost
        scene.bodies["boom"]["bending_y"]["modes"] = 3
    scene.bodies["boom"] = {**scene.bodies["boom"], "length": 4}
    del scene.outputs["tip"]
    result = scene.run()
    assert "tip.x" not in result
    assert numpy.array_equal(result.table, withy.loads(TEXT.replace("length: 8", "length: 4").replace(
        "outputs: {tip: {type: frame, of: boom.tip}}", "")).run().table)
    with pytest.raises(KeyError, match="did you mean 'boom'"):
        scene.bodies["bom"]
    with pytest.raises(withy.SceneError, match='no "lnk" here to change'):  # what set() refused is not forgotten
        withy.loads(TEXT).set("bodies.lnk.length", 2).bodies["boom"]


def test_what_is_wrong_is_said_with_its_path():
    with pytest.raises(withy.SceneError, match="beam/lenght: unknown key \"lenght\"; did you mean 'length'"):
        withy.beam(lenght=8)
    with pytest.raises(withy.SceneError, match=r"(?s)revolute/parent: missing.*revolute/child: missing; need text"):
        withy.revolute(axis=[0, 0, 1])
    with pytest.raises(AttributeError, match="did you mean 'beam'"):
        withy.beem
    scene = boom_on_a_bus()
    scene.bodies["boom"] = {**scene.bodies["boom"], "length": -1, "formulation": "quadratc"}
    scene.hinges["root"] = withy.weld(parent="buss", child="boom")
    with pytest.raises(withy.SceneError, match=r"(?s)/bodies/boom/length: got -1; need finite > 0 \[m\].*did you mean 'bus'") as wrong:
        scene.check()
    line = int(str(wrong.value).split(":")[1])  # of to_yaml()
    assert scene.to_yaml().splitlines()[line - 1].lstrip().startswith("boom:")
    scene.bodies["boom"] = withy.beam(length=float("nan"), mass_per_length=1, bending_y={"stiffness": 1})
    with pytest.raises(withy.SceneError, match="/bodies/boom/length: got nan"):
        scene.check()


def test_every_plugin_has_a_function_that_says_what_it_takes():
    schema = withy._parts.schema()
    for section in ("bodies", "hinges", "loads", "motions", "outputs"):
        for variant in schema["properties"][section]["additionalProperties"]["anyOf"]:
            name = variant["properties"]["type"]["const"].replace("-", "_")
            make = getattr(getattr(withy.parts, section), name)
            text = inspect.getdoc(make)
            assert text.startswith(variant["description"])
            for key, of in variant["properties"].items():
                if key != "type":
                    argument = key + "_" if key in ("from", "in") else key
                    assert f"    {argument}: {of.get('description', '')}" in text, (name, key)
                    assert argument in inspect.signature(make).parameters
    assert "length: length, undeformed [m]; number > 0, required" in withy.beam.__doc__
    assert "modes: number of assumed modes; integer >= 0 and <= 1000, default 2" in withy.beam.__doc__
    assert withy.constant_rate(hinge="axle", rate=1, from_=2) == {"type": "constant-rate", "hinge": "axle", "rate": 1, "from": 2}
    assert withy.parts.integrators.rk4(step=0.01) == {"name": "rk4", "step": 0.01}


def test_the_linear_model_is_that_of_the_equations():
    scene = boom_on_a_bus()
    linear = scene.linearize()
    equations = scene.compile()
    assert linear["inputs"] == ["command"] and len(linear["states"]) == len(equations.names)
    assert numpy.allclose(linear["A"], equations.jacobian(0, equations.y0), rtol=1e-9, atol=1e-9)
    still = equations.derivatives(0, equations.y0)
    equations.inputs["command"] = 2
    assert numpy.allclose(linear["B"][:, 0], (equations.derivatives(0, equations.y0) - still) / 2, rtol=1e-9, atol=1e-12)
    assert scene.linearize(["axle"], ["tip.x"])["C"].shape == (1, len(linear["states"]))


def test_a_linear_model_without_inputs_or_states_has_matrices_of_their_shapes():
    driven = withy.load(SCENES / "spin-up.yaml").linearize()  # its one hinge is driven; the beam has modes
    n, m = len(driven["states"]), len(driven["outputs"])
    assert n > 0 and m > 0 and driven["inputs"] == []
    assert [driven[matrix].shape for matrix in "ABCD"] == [(n, n), (n, 0), (m, n), (m, 0)]
    rigid = boom_on_a_bus()
    del rigid.bodies["boom"], rigid.hinges["root"], rigid.loads["command"], rigid.outputs["tip"]
    rigid.motions["turn"] = withy.constant_rate(hinge="axle", rate=1)
    nothing = rigid.linearize()
    assert nothing["states"] == [] and nothing["outputs"] == ["axle.0", "axle.0.rate"]
    assert [nothing[matrix].shape for matrix in "ABCD"] == [(0, 0), (0, 0), (2, 0), (2, 0)]


def test_the_scene_of_the_documentation_runs(capsys):
    text = (SCENES.parent / "docs/python.md").read_text().partition("## Scenes in code")[2]
    names = {"withy": withy}
    exec(compile(text.partition("```python\n")[2].partition("```")[0], "docs/python.md", "exec"), names)
    # Half a newton metre about the whole, as if rigid: the boom is eight metres long, its root at the axle.
    inertia = 20 + 0.4 * 8**3 / 3
    assert names["result"]["axle"][-1] == pytest.approx(0.5 / inertia * 10**2 / 2, rel=2e-3)
    assert names["linear"]["C"].shape == (2, 6)
    assert withy.loads(capsys.readouterr().out).run().status == "completed"


def test_every_cell_of_the_tutorial_runs_and_says_what_comes_out():
    text = (SCENES.parent / "docs/tutorial-python.md").read_text()
    names = {}
    for cell in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(compile(cell, "docs/tutorial-python.md", "exec"), names)
    assert numpy.allclose(names["frequencies"], [0, 0.55, 1.81], atol=0.01)
    assert names["left_rigid"] == pytest.approx(0.68, abs=0.01)
    assert names["left_with_modes"] == pytest.approx(0.0075, abs=0.0005)
    assert names["tried"] == pytest.approx({300: 0.046, 400: names["left_with_modes"], 500: 0.004}, abs=0.0005)
    assert names["returns"][0] == names["returns"][1]


def test_the_lines_of_the_readme_run(monkeypatch, capsys):
    monkeypatch.chdir(SCENES.parent)
    text = (SCENES.parent / "README.md").read_text()
    exec(compile(text.partition("```python\n")[2].partition("```")[0], "README.md", "exec"), {})
    assert re.fullmatch(r"completed 0\.\d+ m\n", capsys.readouterr().out)


GOOD = """
    import numpy
    import withy
    scene = withy.Scene(gravity=[0, 0, -9.81])
    scene.bodies["boom"] = withy.beam(length="8 m", mass_per_length=[[0, 1.0], [8, 0.5]], bending_y={"stiffness": 1e3})
    scene.hinges["axle"] = withy.revolute(axis=numpy.array([0, 0, 1]), parent="world", child="boom")
    top: float = scene.run(formulation="exact")["axle"].max()
    done: int = withy.sweep("plan.yaml", out="store").done
    """
BAD = """
    import withy
    withy.beam(length=8)                      # error: Missing named argument "mass_per_length"
    withy.rigid(mass=[1])                     # error: incompatible type "List[int]"
    withy.weld(parent="world", chlid="b")     # error: Unexpected keyword argument "chlid"
    withy.beem(length=8)                      # error: has no attribute "beem"
    withy.Scene().run().tabel                 # error: has no attribute "tabel"
    withy.Simulation(withy.Scene()).step("1") # error: incompatible type "str"
    """


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not there (Debian: python3-mypy)")
def test_type_checkers_know_the_package_and_every_part(tmp_path):
    package = pathlib.Path(withy.__file__).parent
    if not (package / "_shortcuts.pyi").exists():
        pytest.skip("built with sanitizers: no types of parts")
    (tmp_path / "good.py").write_text(textwrap.dedent(GOOD))
    (tmp_path / "bad.py").write_text(textwrap.dedent(BAD))

    def mypy(*arguments):
        # The same options, and so one cache of what numpy says of itself.
        return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--ignore-missing-imports", "--cache-dir", str(tmp_path / "cache"),
                               *arguments], cwd=tmp_path, text=True, capture_output=True,
                              env={**os.environ, "MYPYPATH": str(package.parent)}).stdout

    assert mypy("-p", "withy") == ""
    assert mypy("good.py") == ""
    found = mypy("bad.py").splitlines()
    for number, line in enumerate(textwrap.dedent(BAD).splitlines(), 1):
        if "# error: " in line:
            assert any(f.startswith(f"bad.py:{number}: error:") and line.partition("# error: ")[2] in f for f in found), (line, found)
