"""The Python package, as its users call it."""

import concurrent.futures
import copy
import math
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import warnings

import numpy
import pytest

import withy
from turntable import TURNTABLE

SCENES = pathlib.Path(__file__).parents[2] / "scenes"


def test_a_run_is_a_table_by_names(slew):
    result = slew.run()
    assert result.status == "completed" and result.message == ""
    # docs/theory.md: where the arm comes to rest
    assert math.degrees(result["shoulder"][-1]) == pytest.approx(60, abs=0.5)
    assert result.t[-1] == result["t"][-1] == result.final["time"]
    assert result.final["hinges"]["shoulder"]["position"][0] == result["shoulder"][-1]
    assert result.units["shoulder"] == "rad" and "link2.tip.x" in result
    assert numpy.shares_memory(result["shoulder"], result.table)
    # As results.csv calls it.
    assert (result["link1.bending_y.1"] == result["link1.bending_y[1]"]).all() and "link1.bending_y.1" not in list(result)
    assert result.units["link1.bending_y.1"] == result.units["link1.bending_y[1]"] == ""
    with pytest.raises(KeyError, match="did you mean 'shoulder'"):
        result.units["shoulde"]
    assert withy.Simulation(slew).outputs["link1.bending_y.2.rate"] == 0
    assert result.certificate["formulation"]["name"] == "quadratic"
    with pytest.raises(KeyError, match="did you mean 'shoulder'"):
        result["shoulde"]


def test_statistics_are_those_of_outputs_that_ask_for_them(slew):
    assert slew.run().statistics == {}
    watched = slew.copy().set("outputs", "{turn: {type: hinge, hinge: shoulder, statistics: true}}")
    position = watched.run().statistics["turn.position"]
    assert position["unit"] == "rad" and position["max"]["value"] == pytest.approx(math.radians(60), abs=0.01)
    assert position["min"]["t"] < position["max"]["t"] and position["rms"] >= abs(position["mean"])


def test_options_of_a_run_change_the_members_that_they_name_alone():
    arm = withy.load(SCENES / "commanded-arm.yaml")
    arm.set("initial.hinges.shoulder.position", [0.7]).set("bodies.link1.length", 1.5)
    short = {"end": 0.02}
    turned = arm.run(time=short, initial={"hinges": {"elbow": {"position": [0.3]}}})
    assert (turned["shoulder"][0], turned["elbow"][0]) == (0.7, 0.3)
    # What says its type is a part of its own: nothing of the one before it is left.
    rigid = {"type": "rigid", "mass": 1, "inertia": [0.1, 0.1, 0.1, 0, 0, 0], "frames": {"tip": {"position": [1, 0, 0]}}}
    assert "link1.bending_y[1]" not in arm.run(time=short, bodies={"link1": rigid}, outputs={})
    longer = arm.run(time=short, bodies={"link1": {"length": 2}})
    assert longer["link1.tip.x"][0] - turned["link1.tip.x"][0] == pytest.approx(0.5 * math.cos(0.7), abs=1e-9)


def test_scenes_are_values(slew):
    fast = slew.copy().set("loads.slew.time_scale", 1.2).set("integrator.rtol", 1e-5)
    assert slew.run().t[-1] > fast.run(formulation="ruthless").t[-1]
    again = pickle.loads(pickle.dumps(fast))
    assert numpy.array_equal(again.run().table, fast.run().table)
    assert numpy.array_equal(copy.deepcopy(fast).run().table, fast.run().table)
    turned = withy.loads(TURNTABLE).set("gravity", numpy.array([0, 0, -9.81])).set("initial", {"inputs": {"command": 0.2}})
    assert turned.run(time={"end": 1})["axle.rate"][-1] == pytest.approx(1, abs=1e-9)


def test_texts_may_have_any_character():
    with pytest.raises(withy.SceneError, match="\U0001f6f0"):
        withy.loads(TURNTABLE).set("bodies.table", {"type": "modal", "file": "\U0001f6f0.SID_FEM"}).check()


def test_a_scene_that_set_has_completed_can_be_pickled():
    broken = TURNTABLE.replace("mass: ", "mass: -", 1)
    assert broken != TURNTABLE
    mended = withy.loads(broken, check=False).set("bodies.table.mass", 3)
    assert pickle.loads(pickle.dumps(mended)).to_yaml() == mended.to_yaml()


def test_a_scene_keeps_the_files_of_its_folder_wherever_the_process_goes(tmp_path, monkeypatch):
    for name, triangle in (("own", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("other", "f 1 2 3\n")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "shape.obj").write_text(triangle)  # the other one has no vertices
    body = "{type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], visual: {mesh: shape.obj}}"
    (tmp_path / "own" / "scene.yaml").write_text(TURNTABLE.replace("bodies: {", f"bodies: {{ball: {body}, ").replace(
        "hinges: {", "hinges: {pin: {type: weld, parent: table, child: ball}, "))
    monkeypatch.chdir(tmp_path / "own")
    scene = withy.load("scene.yaml")
    built = withy.Scene(time={"end": 1}, bodies=dict(scene.bodies), hinges=dict(scene.hinges))
    built.check()
    monkeypatch.chdir(tmp_path / "other")
    scene.check()
    scene.copy().set("time.end", 1).check()
    scene.copy().set("time.end", 1).unset("time.end").check()
    pickle.loads(pickle.dumps(scene)).check()
    for changed in (scene.copy(), built):
        changed.bodies["ball"] = {**changed.bodies["ball"], "mass": 2}
        changed.check()
    with pytest.raises(withy.SceneError, match="shape.obj"):
        withy.loads((tmp_path / "own" / "scene.yaml").read_text(), "scene.yaml")


def test_plugins_come_of_the_folders_that_were_named_wherever_the_process_goes(tmp_path, monkeypatch):
    (tmp_path / "mine").mkdir()
    monkeypatch.chdir(tmp_path)
    scene = withy.loads(TURNTABLE, plugins=["mine"])
    built = withy.Scene(plugins=["mine"], time={"end": 1}, bodies=dict(scene.bodies), hinges=dict(scene.hinges))
    parts, pickled = withy.Parts(plugins=["mine"]), pickle.dumps(scene)
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a folder that cannot be read is one
        pickle.loads(pickled).check()
        scene.copy().set("time.end", 1).unset("time.end").check()
        for changed in (scene.copy(), built):
            changed.bodies["table"] = {**changed.bodies["table"], "mass": 2}
            changed.check()
        assert parts.hinges.weld(parent="world", child="table")["type"] == "weld"
    with pytest.warns(RuntimeWarning, match="mine cannot be read"):
        withy.loads(TURNTABLE, plugins=["mine"])


def test_a_check_is_that_of_the_program(slew):
    strict = slew.copy().set("integrator", {"name": "imex", "rtol": 1e-4}).set("formulation", "consistent")
    for refused in (strict.check, strict.run, lambda: withy.Simulation(strict)):
        with pytest.raises(withy.SceneError, match="/integrator: .*symmetric mass matrix"):
            refused()
    compared = strict.set("time.end", 0.02).compare()
    assert [one["formulation"] for one in compared["runs"]] == ["ruthless", "quadratic"]
    assert [left["formulation"] for left in compared["left_out"]] == ["inconsistent", "consistent"]
    # Nothing resists the turn: no run can begin.
    point = TURNTABLE.replace("inertia: [0.1, 0.1, 0.2, 0, 0, 0]", "inertia: [0, 0, 0, 0, 0, 0]")
    with pytest.raises(withy.SceneError, match="/hinges/axle: the mass matrix is singular"):
        withy.loads(point)


SET_AND_READ = """
import threading, withy
scene = withy.loads('''
format: withy/1
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
''')
many = {f"f{i}": {"position": [i, 0, 0]} for i in range(200)}
scene.set("bodies.table.frames", many)
over, done = threading.Event(), []
def work():
    while not over.is_set():
        done.append(scene.modes()["formulation"])
threads = [threading.Thread(target=work) for _ in range(2)]
for thread in threads:
    thread.start()
for k in range(200):
    scene.set("bodies.table.frames", many).set("bodies.table.frames.f7.position", [k, 0, 0])
over.set()
for thread in threads:
    thread.join()
assert set(done) == {"quadratic"}
"""


def test_a_scene_is_set_by_one_thread_while_others_work_on_it():
    # In a process of its own: values that are read while they are written end it.
    done = subprocess.run([sys.executable, "-c", SET_AND_READ], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


def test_a_misspelt_set_is_taken_back(slew):
    fast = slew.copy().set("loads.slew.time_scale", 1.2).set("loads.slew.time_scal", 3)
    with pytest.raises(withy.SceneError, match="did you mean 'time_scale'"):
        fast.check()
    with pytest.raises(KeyError, match="did you mean 'loads.slew.time_scal'"):
        fast.unset("loads.slew.time_skal")
    fast.unset("loads.slew.time_scal").check()
    assert fast.to_yaml() == slew.copy().set("loads.slew.time_scale", 1.2).to_yaml()
    assert fast.unset("loads.slew.time_scale").to_yaml() == slew.to_yaml()


def test_errors_have_their_places(slew, tmp_path):
    text = "format: withy/1\nbodies: {b: {type: rigd}}\nhinges: {}\n"
    with pytest.raises(withy.SceneError, match=r"(?s)(?=.*mine.yaml:2:)(?=.*did you mean 'rigid')"):
        withy.loads(text, "mine.yaml")
    broken = withy.loads(text, "mine.yaml", check=False).set("time.end", "soon")
    with pytest.raises(withy.SceneError, match=r"(?s)(?=.*mine.yaml:2:)(?=.*did you mean 'rigid')(?=.*set\(time.end=soon\))"):
        broken.run()
    with pytest.raises(withy.SceneError):
        withy.loads("a: [")
    with pytest.raises(withy.SceneError, match="quadratic"):
        slew.run(formulation="quadratc")
    with pytest.raises(withy.SceneError, match="got NaN; need finite"):
        slew.run(gravity=[0, float("nan"), 0])
    with pytest.raises(FileNotFoundError):
        withy.load(tmp_path / "none.yaml")


def test_ctrl_c_ends_a_run(slew):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        slew.run(time={"end": 1e5})
    timer.join()
    simulation = withy.Simulation(slew)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        simulation.step(1e5)
    timer.join()
    simulation.step(simulation.time + 0.01)  # it goes on


def test_progress_is_told_and_its_errors_are_raised(slew):
    told = []
    slew.run(progress=lambda done, end: told.append(done / end))
    assert told and told == sorted(told) and told[-1] == 1

    def fail(done, end):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        slew.run(time={"end": 1e5}, progress=fail)  # at once: the whole run would take minutes


def test_studies_give_what_the_program_prints(slew):
    scene = slew.set("time.end", 0.3)
    compared = scene.compare(["ruthless", "linear"])
    assert [r["formulation"] for r in compared["runs"]] == ["ruthless", "linear", "quadratic"]
    assert compared["runs"][0]["distance"]["hinges"]["shoulder"] > 0
    assert scene.modes(["shoulder", "elbow"])["points"][0]["modes"][0]["hertz"] > 0
    axes = dict(formulations=["ruthless"], modes=[1], integrators=["dopri5"], tolerances=[1e-4])
    assert len(scene.trade(**axes)["points"]) == 1
    # Outputs that the scene does not define are measures by what they are.
    pushed = ["link2.tip.acceleration"]
    errors = scene.compare(["ruthless"], outputs=pushed)["runs"][0]["outputs"]
    assert {e["output"]: e["distance"] for e in errors}["link2.tip.acceleration.ay"] > 0
    measured = scene.trade(outputs=pushed, **axes)
    assert all(m["output"].startswith("link2.tip.acceleration.") for m in measured["outputs"])
    assert scene.advise("10%", **axes)["advice"]["formulation"] == "ruthless"
    with pytest.raises(withy.SceneError):
        scene.advise("3 kg")
    # A single name is no list of its letters.
    assert scene.compare("linear", outputs="elbow")["runs"][0]["outputs"][0]["output"] == "elbow"
    assert scene.modes("shoulder") == scene.modes(["shoulder"])
    assert scene.linearize(inputs="all")["inputs"] == scene.linearize(inputs=["all"])["inputs"]


def test_a_comparison_that_names_no_formulations_is_of_those_that_fit():
    loop = withy.load(SCENES / "gallery" / "four-bar.yaml").set("time.end", 0.05)
    compared = loop.compare()
    assert [r["formulation"] for r in compared["runs"]] == ["ruthless", "quadratic"]
    assert [left["formulation"] for left in compared["left_out"]] == ["inconsistent", "consistent"]
    assert all("loop" in left["reason"] for left in compared["left_out"])
    # What the command has in the list "runs".
    assert {"formulation", "points"} <= set(withy.load(SCENES / "pendulum.yaml").modes())


def test_results_are_drawn(slew, tmp_path):
    pytest.importorskip("matplotlib")
    axes = slew.run().plot("shoulder", "elbow")
    assert axes.get_ylabel() == "deg" and len(axes.lines) == 2
    axes.figure.savefig(tmp_path / "run.svg")


@pytest.mark.skipif(sys.platform == "darwin", reason="its file systems know names in UTF-8 alone")
def test_names_of_files_need_not_be_utf8(tmp_path):
    name = os.fsencode(tmp_path / "p") + b"\xff.yaml"
    with open(name, "wb") as file:
        file.write((SCENES / "pendulum.yaml").read_bytes())
    for path in (name, os.fsdecode(name)):
        scene = withy.load(path)
        assert scene.run(time={"end": 0.1}).status == "completed"
        again = pickle.loads(pickle.dumps(scene.set("time.end", 0.1)))
        assert again.run().status == "completed" and "p" in repr(again)
    with open(name, "ab") as file:
        file.write(b"\nmass: 3\n")
    with pytest.raises(withy.SceneError, match=re.escape(r"\xff.yaml:")):
        withy.load(os.fsdecode(name))
    with pytest.raises(OSError, match=re.escape(r"none\xff.yaml")):
        withy.load(os.fsdecode(b"none\xff.yaml"))


def test_a_file_of_results_stays_where_the_disk_is_full(slew, tmp_path):
    resource = pytest.importorskip("resource")
    file = tmp_path / "run.h5"
    try:
        slew.run(time={"end": 0.2}).to_hdf5(file)
    except RuntimeError as missing:
        pytest.skip(str(missing))
    before = file.read_bytes()
    longer = slew.run(time={"end": 2, "output": 0.001})
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2 * len(before), limits[1]))
    try:
        with pytest.raises(OSError):
            longer.to_hdf5(file)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert file.read_bytes() == before and os.listdir(tmp_path) == ["run.h5"]
    longer.to_hdf5(file)
    assert file.read_bytes() != before


def test_results_are_kept_as_the_program_keeps_them(slew, tmp_path):
    result = slew.run(time={"end": 0.2})
    try:
        result.to_hdf5(tmp_path / "run.h5")
    except RuntimeError as missing:
        pytest.skip(str(missing))
    with pytest.raises(OSError):
        result.to_hdf5(tmp_path / "none" / "run.h5")
    h5py = pytest.importorskip("h5py", reason="h5py is not there (Debian: python3-h5py)")
    with h5py.File(tmp_path / "run.h5") as file:
        assert file.attrs["status"] in (b"completed", "completed")
        for name in ("t", "shoulder", "link1.tip.deflection_y"):
            assert numpy.array_equal(file[name][:], result[name])


def test_everything_is_documented_with_what_it_raises():
    cannot_fail = {"Scene.copy", "python_load", "python_body"}
    for name in withy.__all__:
        thing = getattr(withy, name)
        assert thing.__doc__, name
        members = {name: thing}
        if isinstance(thing, type):
            members = {f"{name}.{member}": value for base in thing.__mro__ if base.__module__.startswith("withy")
                       for member, value in vars(base).items() if not member.startswith("_") and callable(value)}
        for member, value in members.items():
            if callable(value):
                assert value.__doc__, member
                assert "Raises:" in value.__doc__ or member in cannot_fail, member


def test_what_nobody_has_made_raises(slew):
    simulation = withy.Simulation(slew)
    for act in [
        lambda: withy.Simulation.__new__(withy.Simulation).step(1),
        lambda: withy.Simulation.__new__(withy.Simulation).time,
        lambda: withy.Equations.__new__(withy.Equations).y0,
        lambda: withy.Snapshot.__new__(withy.Snapshot).time,
        lambda: simulation.restore(withy.Snapshot.__new__(withy.Snapshot)),
    ]:
        with pytest.raises(TypeError, match="has not made this object"):
            act()
    simulation.step(0.01)
    simulation.restore(pickle.loads(pickle.dumps(simulation.snapshot())))


def test_the_example_of_the_documentation_runs(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    text = (SCENES.parent / "docs" / "python.md").read_text()
    example = re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1)
    assert len(example.strip().splitlines()) <= 10
    monkeypatch.chdir(tmp_path)
    os.symlink(SCENES, tmp_path / "scenes")
    exec(compile(example, "docs/python.md", "exec"), {})
    assert (tmp_path / "tip.png").stat().st_size > 1000
