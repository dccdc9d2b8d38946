"""Loads and bodies written in Python are those of withy that say the same; what they raise ends a run with its text."""

import multiprocessing
import pathlib
import pickle
import re
import subprocess
import sys
import threading
import traceback

import numpy
import pytest
import withy


def turntable(**loads):
    scene = withy.Scene(time={"end": 1, "output": 0.05}, integrator={"name": "dopri5", "rtol": 1e-9, "atol": 1e-11},
                        initial={"hinges": {"axle": {"position": [0.5]}}})
    scene.bodies["arm"] = withy.rigid(mass=2, center_of_mass=[0.4, 0, 0], inertia=[0.1, 0.1, 0.2, 0, 0, 0],
                                      frames={"tip": {"position": [0.8, 0, 0]}})
    scene.hinges["axle"] = withy.revolute(axis=[0, 0, 1], parent="world", child="arm")
    for name, load in loads.items():
        scene.loads[name] = load
    return scene


class Servo:
    """A proportional and integral controller."""

    states = ["integral"]

    def rates(self, t, w, z):
        return [3 * (0.2 - w[0])]

    def effort(self, t, w, z):
        return 4 * (0.2 - w[0]) + z[0]


class Wind:
    def __init__(self):
        self.asked = 0

    def wrench(self, t, position, R, velocity, angular_velocity):
        self.asked += 1
        assert R.shape == (3, 3)
        assert numpy.allclose(velocity, numpy.cross(angular_velocity, position))
        return (0, 0, 0.5 * t), -0.3 * velocity


def test_loads_at_hinges_and_frames_are_those_of_withy():
    spring = withy.python_load(lambda t, w: -5 * w[0] - 0.2 * w[1], hinge="axle")
    pairs = [(turntable(law=spring), turntable(law=withy.hinge_spring(hinge="axle", stiffness=5, damping=0.2))),
             (turntable(law=withy.python_load(Servo(), of="axle", hinge="axle")),
              turntable(law=withy.pid(hinge="axle", proportional=4, integral=3, reference=0.2))),
             (turntable(law=withy.python_load(Servo(), of="axle", hinge="axle", sample=0.02, delay=0.02)),
              turntable(law=withy.pid(hinge="axle", proportional=4, integral=3, reference=0.2, sample=0.02, delay=0.02)))]
    for mine, own in pairs:
        a, b = mine.run(), own.run()
        assert a.status == b.status == "completed", a.message
        assert numpy.abs(a["axle"] - b["axle"]).max() < 1e-9
        assert numpy.ptp(b["axle"]) > 0.1
    wind = Wind()
    result = turntable(law=withy.python_load(wind, frame="arm.tip")).run()
    assert result.status == "completed", result.message
    assert wind.asked > 50
    # (0.2 + 2 * 0.4^2) x'' = t/2 - 0.3 * 0.8^2 x'
    inertia, brake = 0.52, 0.192
    rate = 0.5 / brake * (result.t - inertia / brake * (1 - numpy.exp(-brake / inertia * result.t)))
    assert numpy.abs(result["axle.rate"] - rate).max() < 1e-8


def test_what_python_raises_is_the_reason_of_the_end():
    def failing(t, w):
        if t > 0.3:
            raise ValueError("no wind today")
        return 0.0

    for options in ({}, {"sample": 0.01}):
        scene = turntable(law=withy.python_load(failing, hinge="axle", **options))
        result = scene.run()
        assert result.status == result.summary["status"] == "load-failed"
        words = re.search(r"load 'law': written in Python \(line (\d+) of the scene\), raised ValueError at t = 0\.3\d* s: "
                          r"no wind today \(test_foreign\.py, line \d+\)\.$", result.message)
        assert words and "type: python" in "".join(scene.to_yaml().splitlines()[int(words[1]) - 1:][:2])
        assert type(result.cause) is ValueError and str(result.cause) == "no wind today"
        assert "in failing" in "".join(traceback.format_tb(result.cause.__traceback__))
        assert result.t[-1] < 0.32 and numpy.isfinite(result["axle"]).all()
    assert turntable(law=withy.python_load(lambda t, w: 0.0, hinge="axle")).run().cause is None
    wrong = turntable(law=withy.python_load(lambda t, w: [1, 2], hinge="axle")).run()
    assert wrong.status == "load-failed" and "effort() gives 2 numbers; need 1" in wrong.message
    sim = withy.Simulation(turntable(law=withy.python_load(failing, hinge="axle")))
    with pytest.raises(withy.SimulationStopped, match="no wind today") as stopped:
        sim.step(1.0)
    assert stopped.value.status == "load-failed" and type(stopped.value.__cause__) is ValueError
    with pytest.raises(withy.SceneError, match="this process has no object of Python 'Servo-1'"):
        turntable(law={"type": "python", "object": "Servo-1", "hinge": "axle"}).check()
    with pytest.raises(withy.SceneError, match="has no wrench"):
        turntable(law=withy.python_load(failing, frame="arm.tip")).check()


def test_what_python_raises_is_the_reason_where_there_is_no_linear_model():
    def failing(t, w):
        raise ValueError("no wind today")

    scene = turntable(law=withy.python_load(failing, hinge="axle"))
    with pytest.raises(withy.SimulationStopped, match=r"load 'law': written in Python .* no wind today") as stopped:
        scene.linearize()
    assert stopped.value.status == "load-failed" and type(stopped.value.__cause__) is ValueError
    assert "no wind today" in scene.modes()["points"][0]["problem"]


@pytest.mark.parametrize("wrong", [{"component": 0}, {"sample": 0.1, "delay": 0.1}, {"delay": 0.1}, {"hinge": "axle"}])
def test_a_load_at_a_frame_refuses_what_is_of_hinges_and_samples(wrong):
    with pytest.raises(withy.SceneError, match="a load at a frame has none"):
        turntable(wind=withy.python_load(Wind(), frame="arm.tip", **wrong)).check()


class Mute(Exception):
    def __str__(self):
        raise RuntimeError("no text")


def test_an_exception_without_a_text_ends_a_run_too():
    def mute(t, w):
        raise Mute

    result = turntable(law=withy.python_load(mute, hinge="axle")).run()
    assert result.status == "load-failed" and "raised an exception at t = 0 s" in result.message
    assert type(result.cause) is Mute


def test_an_interrupt_within_a_law_is_raised_where_the_call_comes_back():
    def law(t, w):
        if t > 0.3:
            raise KeyboardInterrupt
        return 0.0

    scene = turntable(law=withy.python_load(law, hinge="axle"))
    with pytest.raises(KeyboardInterrupt):
        scene.run()
    simulation = withy.Simulation(scene)
    with pytest.raises(KeyboardInterrupt):
        simulation.step(1)


def test_a_law_that_asks_its_own_simulation_is_refused_what_it_would_wait_for():
    own = {}
    times = []

    def law(t, w):
        if "simulation" in own:
            times.append(own["simulation"].time)  # what only reads is given
            own["simulation"].outputs["axle"]
        return 0.0

    own["simulation"] = withy.Simulation(turntable(law=withy.python_load(law, hinge="axle")))
    with pytest.raises(withy.SimulationStopped, match="RuntimeError.*it is at work and calls this code"):
        own["simulation"].step(0.1)
    assert times[0] == 0


@pytest.mark.parametrize("given, words", [(None, "gives None; need numbers"), ("much", "could not convert"),
                                          ([1, 2], "effort.. gives 2 numbers; need 1")])
def test_what_a_law_gives_that_is_no_number_is_the_reason_of_the_end(given, words):
    result = turntable(law=withy.python_load(lambda t, w: given, hinge="axle")).run()
    assert result.status == "load-failed"
    assert re.search(words, result.message), result.message


def test_a_forked_process_has_the_scenes_and_the_objects_of_before():
    scene = turntable(law=withy.python_load(Servo(), of="axle", hinge="axle"))
    expected = scene.run()["axle"]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for got in pool.map(axle_of, [scene] * 4):
            assert numpy.array_equal(got, expected)


def axle_of(scene):
    return scene.run()["axle"]


def test_who_goes_back_before_a_failure_goes_on():
    down = []

    def moody(t, w):
        if down and t > 0.3:
            raise ValueError(down[0])
        return -5 * w[0]

    for options in ({}, {"sample": 0.01}):
        down.clear()
        scene = turntable(law=withy.python_load(moody, hinge="axle", **options))
        sim = withy.Simulation(scene)
        sim.step(0.2)
        middle = sim.snapshot()
        sim.step(0.5)
        there = sim.outputs["axle"]
        sim.restore(middle)
        for why in ("first", "second"):
            down[:] = [why]
            with pytest.raises(withy.SimulationStopped, match=f"load 'law': .* raised ValueError at t = 0\\.\\d* s: {why}"):
                sim.step(0.5)
            sim.restore(middle)
        down.clear()
        sim.step(0.5)
        assert sim.outputs["axle"] == there
    equations = turntable(law=withy.python_load(moody, hinge="axle")).compile()
    down[:] = ["no"]
    with pytest.raises(withy.SimulationStopped, match="load 'law': .* raised ValueError at t = 0.4 s: no "):
        equations.derivatives(0.4, equations.y0)
    assert numpy.isfinite(equations.derivatives(0.2, equations.y0)).all()


def test_a_pickled_scene_means_something_in_this_process_alone(tmp_path):
    scene = turntable(law=withy.python_load(Servo(), of="axle", hinge="axle"))
    text = pickle.dumps(scene)
    assert numpy.array_equal(pickle.loads(text).run()["axle"], scene.run()["axle"])
    (tmp_path / "scene").write_bytes(text)
    code = "import pickle, sys, withy; pickle.load(open(sys.argv[1], 'rb')).check()"
    elsewhere = subprocess.run([sys.executable, "-c", code, tmp_path / "scene"], capture_output=True, text=True, check=False)
    assert elsewhere.returncode == 1
    assert "this process has no object of Python 'Servo-" in elsewhere.stderr


def test_studies_ask_python_from_several_threads():
    scene = turntable(law=withy.python_load(lambda t, w: -5 * w[0], hinge="axle"))
    trade = scene.trade(formulations=["quadratic"], integrators=["dopri5", "rk4"], tolerances=[1e-4, 1e-6], jobs=3)
    own = turntable(law=withy.hinge_spring(hinge="axle", stiffness=5)).trade(
        formulations=["quadratic"], integrators=["dopri5", "rk4"], tolerances=[1e-4, 1e-6], jobs=1)
    # Nothing where a run did not come to its end.
    errors = [numpy.array([point["hinge_error"] for point in of["points"]], dtype=float) for of in (trade, own)]
    assert numpy.allclose(*errors, rtol=1e-3, atol=1e-12, equal_nan=True) and len(errors[0]) >= 4
    assert numpy.isfinite(errors[0]).sum() >= 2
    slopes = scene.linearize()
    assert numpy.abs(numpy.array(slopes["A"])[1, 0] + 5 / 0.52) < 1e-5


def test_threads_share_equations_with_a_law_in_python():
    equations = turntable(law=withy.python_load(lambda t, w: -5 * w[0], hinge="axle")).compile()
    expected = equations.derivatives(0.0, equations.y0)
    wrong = []

    def ask():
        for _ in range(200):
            equations.normalize(equations.y0)
            if not numpy.array_equal(equations.derivatives(0.0, equations.y0), expected):
                wrong.append(1)

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not wrong and not any(thread.is_alive() for thread in threads)


class Rod:
    """A uniform rod along x with one mode w = q x^2, that shortens by its slope (the third term of gamma is zero)."""

    def __init__(self, points=20):
        x, weights = numpy.polynomial.legendre.leggauss(points)
        self.x, self.weights = (x + 1) / 2, weights / 2

    def at(self, x):
        gamma = numpy.zeros((3, 1, 1))
        gamma[0] = -4 * x**3 / 3
        return {"position": [x, 0, 0], "phi": [[0], [x * x], [0]], "psi": [[0], [0], [2 * x]], "gamma": gamma}

    def shape(self):
        return {"modes": ["bending[1]"], "length": 1, "stiffness": [[4 * 7.0]], "stations": {"tip": self.at(1.0)},
                "particles": [{"mass": 0.6 * w, **self.at(x)} for x, w in zip(self.x, self.weights)]}


def test_a_body_is_what_its_shape_says():
    scene = withy.Scene(time={"end": 1, "output": 0.05}, formulation="quadratic",
                        initial={"bodies": {"rod": {"modes": [0.01]}}})
    scene.bodies["rod"] = withy.python_body(Rod(), frames={"end": {"at": "tip"}})
    scene.hinges["root"] = withy.weld(parent="world", child="rod")
    scene.outputs["tip"] = withy.frame(of="rod.end")
    # m = 0.6/5 and k = 28: w^2 = k/m.
    result = scene.run()
    assert result.status == "completed", result.message
    assert numpy.abs(result["rod.bending[1]"] - 0.01 * numpy.cos((28 / 0.12) ** 0.5 * result.t)).max() < 1e-4
    assert numpy.abs(result["tip.y"] - result["rod.bending[1]"]).max() < 1e-12
    scene.bodies["rod"] = withy.python_body(type("Bad", (), {"shape": lambda self: {"particles": [{"mass": -1}]}})())
    with pytest.raises(withy.SceneError, match="masses of at least 0"):
        scene.check()


MASS = {"mass": 1, "position": [1, 0, 0]}


@pytest.mark.parametrize("shape, problem", [
    ({"particles": [{**MASS, "ph": [[0]]}]}, "particles[0].ph: unknown key \"ph\"; did you mean 'phi'?"),
    ({"particles": [MASS], "sitffness": [[28]]}, "sitffness: unknown key \"sitffness\"; did you mean 'stiffness'?"),
    ({"particles": [MASS], "sections": [{"mass": 1}]}, "sections[0].mass: unknown key \"mass\""),
    ({"particles": [MASS], "stations": {"tip": {"at": 1}}}, "stations.tip.at: unknown key \"at\""),
    ({"particles": [MASS, {"mass": "x"}]}, "particles[1].mass: need a number, not str"),
    ({"particles": [{"position": [1, 0, 0]}]}, "particles[0].mass: missing"),
    ({"particles": [MASS], "modes": "bending"}, "modes: need a list of names, not str"),
    ({"particles": [MASS], "modes": ["a"], "stiffness": "stiff"}, "stiffness: could not convert string to float"),
    ({"particles": [MASS], "modes": ["a"], "damping": None}, "damping: need numbers, not NoneType"),
    ({"particles": 1}, "particles: need a list of dicts, not int"),
    (None, "shape(): need a dict, not NoneType"),
])
def test_what_a_shape_cannot_say_is_told_with_its_place(shape, problem):
    scene = withy.Scene(time={"end": 1})
    scene.bodies["rod"] = withy.python_body(type("Body", (), {"shape": lambda self: shape})())
    scene.hinges["root"] = withy.weld(parent="world", child="rod")
    with pytest.raises(withy.SceneError, match=re.escape(f"/bodies/rod/object: Python: {problem}")):
        scene.check()


def test_the_page_s_example_runs(monkeypatch, capsys):
    sources = pathlib.Path(__file__).parents[2]
    text = (sources / "docs" / "python.md").read_text().partition("## Loads and bodies in Python")[2]
    monkeypatch.chdir(sources)
    exec(compile(text.partition("```python\n")[2].partition("```")[0], "docs/python.md", "exec"), {})
    assert "completed" in capsys.readouterr().out
