"""Steady states, small motions, inverse dynamics, fits: against closed forms, and what the program prints."""

import json
import math
import os
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import withy

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
PROGRAM = os.environ.get("WITHY_PROGRAM")

J, K, C = 2.0, 8.0, 0.4
WHEEL = f"""
format: withy/1
time: {{end: 2, output: 0.05}}
integrator: {{name: dopri5, rtol: 1e-10, atol: 1e-12}}
bodies: {{wheel: {{type: rigid, mass: 1, inertia: [1, 1, {J}, 0, 0, 0]}}}}
hinges: {{axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}}}
loads:
  spring: {{type: hinge-spring, hinge: axle, stiffness: {K}, damping: {C}}}
  command: {{type: input, hinge: axle}}
"""

# A bead on a spoke of a turntable, held by a spring: k/m is 25.
BEAD = """
format: withy/1
bodies:
  table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  bead: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}
  slide: {type: prismatic, axis: [1, 0, 0], parent: table, child: bead}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 50}}
"""


@pytest.fixture
def wheel():
    return withy.loads(WHEEL)


@pytest.fixture
def bead():
    return withy.loads(BEAD)


def rotor():
    """Three equal blades that lag in the plane of the rotor. Hinges are on the axis: turning does not stiffen them."""
    scene = withy.Scene()
    frames = {f"r{k}": {"orientation": [math.cos(math.pi / 3 * k), 0, 0, math.sin(math.pi / 3 * k)]} for k in (0, 1, 2)}
    scene.bodies["hub"] = withy.rigid(mass=1, inertia=[1, 1, 1, 0, 0, 0], frames=frames)
    scene.hinges["shaft"] = withy.revolute(axis=[0, 0, 1], parent="world", child="hub")
    for k in (0, 1, 2):
        scene.bodies[f"b{k}"] = withy.rigid(mass=2, center_of_mass=[1, 0, 0], inertia=[0.1, 1, 1, 0, 0, 0])
        scene.hinges[f"l{k}"] = withy.revolute(axis=[0, 0, 1], parent=f"hub.r{k}", child=f"b{k}")
        scene.loads[f"s{k}"] = withy.hinge_spring(hinge=f"l{k}", stiffness=75)
    return scene


def frequencies(point):
    return [mode["frequency"] for mode in point["modes"]]


def test_a_response_is_that_of_an_oscillator(wheel):
    found = wheel.response("command", "axle", from_=0.01, to=10, reduce=1)
    s = 2j * math.pi * found["hertz"]
    assert found["values"].dtype == complex and len(s) == len(found["values"]) > 300
    assert found["hertz"][0] == pytest.approx(0.01) and found["hertz"][-1] == pytest.approx(10)
    assert numpy.allclose(found["values"], 1 / (J * s**2 + C * s + K), rtol=1e-9)
    assert found["static_gain"] == pytest.approx(1 / K) and not found["opened"]
    assert len(found["poles"]) == 2 and found["poles"][0]["damping_ratio"] == pytest.approx(C / 2 / math.sqrt(K * J))
    assert [found["reduction"][matrix].shape for matrix in "ABCD"] == [(1, 1)] * 4
    coarse = wheel.response("command", "axle", from_=0.01, to=10, points=5)
    assert len(coarse["hertz"]) < len(s) and coarse["reduction"] is None
    # An output that the scene does not define.
    acceleration = wheel.response("command", "axle.acceleration", from_=1, to=2)
    s = 2j * math.pi * acceleration["hertz"]
    assert numpy.allclose(acceleration["values"], s**2 / (J * s**2 + C * s + K), rtol=1e-6)


def test_a_loop_is_opened():
    scene = withy.loads(WHEEL.replace("spring: {", "spare: {"))
    scene.loads["control"] = withy.pd_controller(law="constant", hinges={"axle": {"stiffness": 6, "damping": 3}})
    found = scene.response("control")
    s = 2j * math.pi * found["hertz"]
    assert found["opened"]
    assert numpy.allclose(found["values"], (3 * s + 6) / (J * s**2 + C * s + K), rtol=1e-9)
    assert found["margins"]["stable"]


def test_an_equilibrium_balances_and_begins_other_studies(wheel):
    wheel.set("initial.inputs.command", 2)
    found = wheel.equilibrium()
    assert found["converged"] and found["stays_steady"] and found["stability"]["stable"]
    state = found["state"]
    assert state["hinges"]["axle"]["position"][0] == pytest.approx(2 / K)
    # It is the start of other studies and of runs.
    assert not wheel.linearize()["equilibrium"] and wheel.linearize(at=state)["equilibrium"]
    assert wheel.response("command", "axle", at=state)["equilibrium"]
    stays = wheel.copy().set("initial", state).run()["axle"]
    assert stays == pytest.approx(2 / K, abs=1e-9)
    held = wheel.equilibrium("axle")
    assert held["efforts"]["axle.0"] == pytest.approx(-2) and held["stability"] is None


def test_a_beam_bends_under_its_weight():
    scene = withy.Scene(gravity=[0, -9.81, 0])
    scene.bodies["boom"] = withy.beam(length=1, mass_per_length=0.01, bending_y={"stiffness": 50, "modes": 4})
    scene.hinges["root"] = withy.weld(parent="world", child="boom")
    tip = scene.equilibrium()["tip_deflections"]["boom.tip"]
    assert tip.shape == (3,) and tip[1] == pytest.approx(-0.01 * 9.81 / (8 * 50), rel=1e-3)


def test_no_equilibrium_is_told_and_not_raised():
    falling = withy.loads(WHEEL.replace("spring: {", "spare: {").replace(f"stiffness: {K}", "stiffness: 0"))
    found = falling.set("initial.inputs.command", 2).equilibrium()
    assert not found["converged"] and "axle" in found["message"]


def test_modes_of_what_turns(bead):
    assert frequencies(bead.modes("axle")["points"][0]) == pytest.approx([5])
    for spin in ({"axle": 3}, {"axle": numpy.float64(3)}, "axle=3", ["axle=3"], {"axle": f"{3 * 30 / math.pi} rpm"}):
        assert frequencies(bead.modes(spin=spin)["points"][0]) == pytest.approx([4]), spin
    swept = bead.modes(sweep="spin.axle=0:4:5")
    assert [point["value"] for point in swept["points"]] == [0, 1, 2, 3, 4]
    assert [frequencies(p)[-1] for p in swept["points"]] == pytest.approx([math.sqrt(25 - w**2) for w in range(5)])
    # The rates of a state hold a hinge as well.
    turning = {"hinges": {"axle": {"rate": [3]}}}
    assert frequencies(bead.modes("axle", at=turning)["points"][0]) == pytest.approx([4])
    linear = bead.linearize("slide", "slide", spin={"axle": 3})
    assert linear["states"] == ["slide.0", "slide.0.rate"]
    assert numpy.allclose(linear["A"], [[0, 1], [-16, 0]]) and numpy.allclose(linear["B"], [[0], [0.5]])
    assert bead.response("slide", "slide", spin={"axle": 3})["static_gain"] == pytest.approx(1 / 32)


def test_blades_are_seen_from_where_the_rotor_does_not_turn(bead):
    scene = rotor()
    for blades in ("auto", ["b0", "b1", "b2"]):
        turn = scene.modes(spin={"shaft": 2}, blades=blades, floquet=True)["points"][0]["turn"]
        assert [mode["exponent"][1] for mode in turn["multiblade"]["modes"]] == pytest.approx([3, 5, 7])
        assert turn["period"] == pytest.approx(math.pi) and turn["floquet"]["stable"]
    assert "multiblade" not in scene.modes(spin={"shaft": 2})["points"][0]["turn"]
    assert "nothing turns" in scene.modes(blades="auto")["points"][0]["turn"]["problem"]
    turn = bead.modes(spin={"axle": 3}, blades="auto")["points"][0]["turn"]
    assert "no three equal blades" in turn["blade_problem"] and "multiblade" not in turn
    with pytest.raises(withy.SceneError, match="period"):
        scene.modes(spin={"shaft": 2}, floquet=True, period=-1)


def test_effective_masses_and_damping_go_with_modes(bead):
    found = bead.modes("axle", as_is=True, effective_mass=True)
    assert found["effective_mass"]["modes"][0]["mass"] == pytest.approx([2, 0, 0])
    beam = withy.load(SCENES / "solar-panel.yaml")
    assert {"set", "modes"} <= set(beam.modes(as_is=True, damp=["1%"])["damping"])
    for beside in ({"effective_mass": True}, {"damp": [0.01]}):
        with pytest.raises(withy.SceneError, match="of one configuration"):
            bead.modes(sweep="spin.axle=0:4:5", **beside)


def test_inverse_dynamics_of_a_cubic(wheel):
    t = numpy.linspace(0, 2, 41)
    found = wheel.inverse({"t": t, "axle": 0.1 * t**3})
    drive = found["drives"]["axle.0"]
    assert found["status"] == "completed" and found["t"] == pytest.approx(t, abs=1e-12)
    assert drive["rate"] == pytest.approx(0.3 * t**2, abs=1e-9)
    effort = J * 0.6 * t + C * 0.3 * t**2 + K * 0.1 * t**3
    assert drive["unit"] == "N m" and drive["effort"] == pytest.approx(effort, abs=1e-8)
    assert drive["peak_effort"] == pytest.approx(effort[-1]) and drive["peak_time"] == pytest.approx(2)
    assert found["run"]["axle"] == pytest.approx(0.1 * t**3, abs=1e-9)
    # Degrees, and what no hinge has the name of.
    degrees = wheel.inverse({"t[s]": t, "axle[deg]": numpy.degrees(0.1 * t**3), "note": t})
    assert degrees["drives"]["axle.0"]["effort"] == pytest.approx(effort, abs=1e-8) and degrees["ignored"] == ["note"]
    # A run is a motion: its own spring and damper move the wheel, so that nothing is left to do.
    swings = wheel.copy().set("initial.hinges.axle.position", [0.3]).set("time.output", 0.01)
    left = wheel.copy().set("time.output", 0.01).inverse(swings.run())["drives"]["axle.0"]["effort"]
    assert numpy.abs(left[5:-5]).max() < 1e-3
    with pytest.raises(withy.SceneError, match="no hinge is driven"):
        wheel.inverse()
    with pytest.raises(withy.SceneError, match="motion:1:3: no hinge is named 'axel'; did you mean 'axle'"):
        wheel.inverse({"t": t, "axel": t})
    with pytest.raises(ValueError, match="columns of one length"):
        wheel.inverse({"t": t, "axle": t[1:]})


def test_a_fit_finds_what_made_the_data(wheel):
    wheel.set("initial.hinges.axle.position", [0.3])
    data = wheel.copy().set("loads.spring.stiffness", 9.1).set("loads.spring.damping", 0.7).run()
    told = []
    fit = wheel.tune({"loads.spring.stiffness": (5, 12), "loads.spring.damping": None}, data, outputs="axle",
                     progress=lambda done, all_: told.append((done, all_)))
    assert fit["converged"] and fit["trouble"] == "" and told == [(1, 1)]
    assert [p["value"] for p in fit["parameters"]] == pytest.approx([9.1, 0.7], rel=1e-5)
    assert fit["parameters"][0]["bounds"] == [5, 12] and fit["parameters"][1]["bounds"] == [None, None]
    assert fit["correlation"].shape == (2, 2) and fit["singular_values"].shape == (2,)
    column, = fit["columns"]
    assert column["name"] == "axle" and fit["t"] == pytest.approx(data.t)
    assert column["measured"] == pytest.approx(data["axle"])
    assert column["fitted"] == pytest.approx(data["axle"], abs=1e-6)
    assert column["before"] == pytest.approx(wheel.run()["axle"], abs=1e-6)
    for path, value in fit["changes"].items():
        wheel.set(path, value)
    assert wheel.run()["axle"] == pytest.approx(data["axle"], abs=1e-6)


def test_masked_values_count_as_gaps(wheel):
    made = wheel.copy().set("loads.spring.stiffness", 9.1).set("initial.hinges.axle.position", [0.3]).run()
    wrong = numpy.array(made["axle"])
    wrong[3:9] = 7
    masked = numpy.ma.masked_equal(wrong, 7)
    fit = wheel.set("initial.hinges.axle.position", [0.3]).tune("loads.spring.stiffness=5..", {"t": made.t, "axle": masked})
    assert fit["parameters"][0]["value"] == pytest.approx(9.1, rel=1e-4)
    assert fit["data"]["values"] == len(wrong) - 6
    with pytest.raises(withy.SceneError, match="nan"):
        wheel.inverse({"t": made.t, "axle": masked})
    whole = numpy.ma.array((0.1 * made.t**2), mask=False)
    assert wheel.inverse({"t": made.t, "axle": whole})["status"] == "completed"


def test_files_of_other_encodings_are_refused_in_words(wheel, tmp_path):
    table = tmp_path / "table.csv"
    table.write_bytes("t[s],axle[\u00b0]\n0,1\n1,2\n2,3\n".encode("latin1"))
    for study in (lambda: wheel.tune(["loads.spring.stiffness"], table), lambda: wheel.inverse(table)):
        with pytest.raises(withy.SceneError, match=re.escape(r"\xb0")):
            study()


def test_a_fit_takes_tables_with_gaps_and_deviations(wheel):
    wheel.set("initial.hinges.axle.position", [0.3])
    made = wheel.copy().set("loads.spring.stiffness", 9.1).run()
    degrees = numpy.degrees(made["axle"])
    degrees[3] = math.nan
    fit = wheel.tune("loads.spring.stiffness=5..", {"t[s]": made.t, "axle[deg]": degrees},
                     deviations={"axle": "0.1 deg"}, starts=2)
    assert fit["parameters"][0]["value"] == pytest.approx(9.1, rel=1e-4) and len(fit["starts"]) == 2
    assert fit["data"]["values"] == len(degrees) - 1 and math.isnan(fit["columns"][0]["measured"][3])
    # All that is wrong is said at once.
    wrong = r"(?s)(?=.*did you mean 'spring')(?=.*match:4:\d+: got)(?=.*starts: got 0)"
    with pytest.raises(withy.SceneError, match=wrong):
        wheel.tune("loads.sprin.stiffness", {"t": [0, 1, math.inf], "axle": [0, 1, 2]}, starts=0)
    untold = wheel.tune("bodies.wheel.mass", made, outputs="axle")
    assert not untold["converged"] and untold["trouble"] and untold["changes"] == {}


def test_what_is_asked_wrongly_is_said_with_its_place(bead, tmp_path):
    for call in (bead.modes, bead.equilibrium, bead.linearize, lambda **of: bead.response("slide", "slide", **of)):
        with pytest.raises(withy.SceneError, match="spin: .*need HINGE=RATE"):
            call(spin="axle")
        with pytest.raises(withy.SceneError, match="spin: .*known: axle, slide"):
            call(spin={"axel": 1})
        wrong = "(?s)(?=.*at:1:.*did you mean 'axle')(?=.*at:1:.*did you mean 'bodies')"
        with pytest.raises(withy.SceneError, match=wrong):
            call(at={"hinges": {"axel": {"position": [1]}}, "bodes": {}})
        with pytest.raises(FileNotFoundError):
            call(at=tmp_path / "none.json")
    state = tmp_path / "state.json"
    state.write_text(json.dumps({"hinges": {"axle": {"rate": [3]}}}))
    assert frequencies(bead.modes("axle", at=state)["points"][0]) == pytest.approx([4])
    with pytest.raises(withy.SceneError, match="does not feel"):
        bead.response("axle", "slide")
    with pytest.raises(withy.SceneError, match="points: got 1"):
        bead.response("slide", "slide", points=1)
    with pytest.raises(withy.SceneError, match="need above 0"):
        bead.response("slide", "slide", from_=2, to=1)
    with pytest.raises(withy.SceneError, match="sweep"):
        bead.modes(sweep="spin.axle=0")


def test_a_law_that_fails_stops_a_response(wheel):
    def law(t, w):
        raise ZeroDivisionError("no law today")

    wheel.loads["law"] = withy.python_load(law, hinge="axle")
    with pytest.raises(withy.SimulationStopped, match="no law today"):
        wheel.response("command", "axle")


ASKED_WHILE_SET = f"""
import threading, withy
scene = withy.loads('''{WHEEL}''')
many = {{f"f{{i}}": {{"position": [i, 0, 0]}} for i in range(200)}}
scene.set("bodies.wheel.frames", many)
over, failed = threading.Event(), []
def work(study):
    while not over.is_set():
        try:
            study()
        except BaseException as error:
            failed.append(error)
t = [0.05 * k for k in range(41)]
studies = [lambda: scene.equilibrium(at={{"hinges": {{"axle": {{"position": [0.1]}}}}}}),
           lambda: scene.response("command", "axle", points=5),
           lambda: scene.inverse({{"t": t, "axle": [x**2 for x in t]}}),
           lambda: scene.tune("loads.spring.stiffness", {{"t": t, "axle": [x**2 for x in t]}}),
           lambda: scene.modes(count=0)]
threads = [threading.Thread(target=work, args=(study,)) for study in studies]
for thread in threads:
    thread.start()
for k in range(200):
    scene.set("bodies.wheel.frames", many).set("bodies.wheel.frames.f7.position", [k, 0, 0])
over.set()
for thread in threads:
    thread.join()
assert not failed, failed[0]
"""


def test_a_scene_is_set_while_others_study_it():
    # In a process of its own: values that are read while they are written end it.
    done = subprocess.run([sys.executable, "-c", ASKED_WHILE_SET], capture_output=True, text=True, timeout=120,
                          check=False)
    assert done.returncode == 0, done.stderr


def test_the_studies_of_the_documentation_run(monkeypatch):
    monkeypatch.chdir(SCENES.parent)
    text = (SCENES.parent / "docs/python.md").read_text().partition("## Studies")[2]
    names = {}
    exec(compile(text.partition("```python\n")[2].partition("```")[0], "docs/python.md", "exec"), names)
    assert names["bent"]["converged"] and names["linear"]["A"].shape == (len(names["linear"]["states"]),) * 2
    assert names["loop"]["margins"]["stable"] and len(names["gain"]) == len(names["phase"])
    assert names["driven"]["status"] == "completed"
    assert len(names["driven"]["drives"]["shoulder.0"]["effort"]) == 41  # the outputs of the scene
    assert names["pendulum"].bodies["rod"]["center_of_mass"][1] == pytest.approx(-0.5226, abs=1e-3)


def plainly(value):
    """As the program prints it: what is not finite is null."""
    if isinstance(value, dict):
        return {key: plainly(member) for key, member in value.items()}
    if isinstance(value, (list, tuple)):
        return [plainly(member) for member in value]
    return plainly(value.tolist()) if isinstance(value, numpy.ndarray) else value


@pytest.mark.skipif(not PROGRAM, reason="needs WITHY_PROGRAM, the command line")
def test_studies_are_those_of_the_program(tmp_path):
    def printed(*words):
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    arm, blade = SCENES / "two-link-slew.yaml", SCENES / "rotating-blade.yaml"
    bent = SCENES / "states/two-link-bent.json"
    weight = ("--set", "gravity.1=-9.81")
    heavy = withy.load(arm).set("gravity.1", -9.81)
    assert plainly(heavy.equilibrium(["shoulder", "elbow"])) == printed(
        "equilibrium", arm, "--lock", "shoulder,elbow", *weight, "--json")
    linear = withy.load(arm).linearize("shoulder", ["elbow.0.rate", "link2.tip"], "elbow", at=bent)
    assert plainly(linear) == printed("linearize", arm, "--inputs", "shoulder", "--outputs", "elbow.0.rate,link2.tip",
                                      "--lock", "elbow", "--at", bent)
    assert plainly(withy.load(blade).modes(spin={"axle": 6}, count=4)) == printed(
        "modes", blade, "--spin", "axle=6", "--count", "4", "--json")["runs"][0]
    masses = withy.load(SCENES / "solar-panel.yaml").modes(as_is=True, effective_mass=True)["effective_mass"]
    assert plainly(masses) == printed("modes", SCENES / "solar-panel.yaml", "--as-is", "--effective-mass",
                                      "--json")["effective_mass"]

    loop = withy.load(SCENES / "pd-arm.yaml").response("control.shoulder", to=50, reduce=4)
    of_program = printed("response", SCENES / "pd-arm.yaml", "--input", "control.shoulder", "--to", "50",
                         "--reduce", "4", "--json")
    rows = numpy.array(of_program.pop("values"))
    assert (loop.pop("hertz") == rows[:, 0]).all() and (loop.pop("values") == rows[:, 1] + 1j * rows[:, 2]).all()
    assert plainly(loop) == of_program

    motion = SCENES / "motions/two-link-pick.csv"
    picks = withy.load(arm).set("loads", {}).inverse(motion)
    run = picks.pop("run")
    t = picks.pop("t")
    of_program = printed("inverse", arm, "--motion", motion, "--set", "loads={}", "--out", "pick", "--json")
    for name, drive in picks["drives"].items():
        effort = drive.pop("effort")
        assert len(effort) == len(drive.pop("rate")) == len(t) == len(run.t), name
        assert effort[numpy.abs(effort).argmax()] == drive["peak_effort"], name
    assert plainly(picks) == of_program

    pendulum, data = SCENES / "pendulum.yaml", SCENES / "measured/pendulum.csv"
    fit = withy.load(pendulum).tune("bodies.rod.center_of_mass.1=-0.8..-0.2", data)
    for beside in ("t", "changes"):
        del fit[beside]
    for column in fit["columns"]:
        del column["measured"], column["before"], column["fitted"]
    assert plainly(fit) == printed("tune", pendulum, "--match", data, "--parameters",
                                   "bodies.rod.center_of_mass.1=-0.8..-0.2", "--json")
