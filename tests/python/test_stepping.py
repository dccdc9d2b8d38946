"""Simulations that a host steps, and equations for a host's own integrator."""

import concurrent.futures
import math
import pathlib
import pickle
import threading

import numpy
import pytest

import withy
from turntable import TURNTABLE

SCENES = pathlib.Path(__file__).parents[2] / "scenes"


def rk4(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h / 2, y + h / 2 * k1)
    k3 = f(t + h / 2, y + h / 2 * k2)
    k4 = f(t + h, y + h * k3)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def test_a_simulation_is_stepped():
    simulation = withy.Simulation(withy.loads(TURNTABLE))
    assert list(simulation.inputs) == ["command"] and simulation.inputs.units["command"] == "N m"
    x = v = 0.0
    for t, effort in ((0.5, 0.4), (0.75, -0.2), (2.0, 0.1)):
        h, a = t - simulation.time, effort / 0.2
        simulation.inputs["command"] = effort
        simulation.step(t)
        x, v = x + h * v + h * h / 2 * a, v + h * a
        assert simulation.time == t
        assert simulation.outputs["axle"] == pytest.approx(x, abs=1e-9)
        assert simulation.outputs["axle.rate"] == pytest.approx(v, abs=1e-9)
    without = withy.loads(TURNTABLE.replace("loads: {command: {type: input, hinge: axle}}", ""))
    with pytest.raises(KeyError, match="no input 'push'; there is none"):
        withy.Simulation(without).inputs["push"]
    with pytest.raises(KeyError, match="did you mean 'command'"):
        simulation.inputs["comand"] = 1
    with pytest.raises(KeyError, match="did you mean 'axle'"):
        simulation.outputs["axel"]
    with pytest.raises(ValueError):
        simulation.inputs["command"] = float("nan")
    with pytest.raises(ValueError, match="before the present one"):
        simulation.step(1.0)


def test_a_simulation_refuses_what_is_not_its_own(slew):
    sim = withy.Simulation(slew)
    sim.step(0.1)
    for wrong, why in ((0.05, "lies before the present one"), (float("nan"), "need a finite number")):
        for call in (sim.step, sim.advance_to):
            with pytest.raises(ValueError, match=why):
                call(wrong)
    with pytest.raises(ValueError, match="the snapshot is of another scene"):
        sim.restore(withy.Simulation(withy.load(SCENES / "pendulum.yaml")).snapshot())
    assert sim.time == 0.1


def test_snapshots_replay_bit_by_bit():
    simulation = withy.Simulation(withy.loads(TURNTABLE).set("loads.command.hold", "linear"))

    def drive(s, first, last):
        rows = []
        for k in range(first, last):
            s.inputs["command"] = math.sin(k)
            s.step(0.1 * (k + 1))
            rows.append(dict(s.outputs))
        return rows

    drive(simulation, 0, 5)
    snapshot = simulation.snapshot()
    went_on = drive(simulation, 5, 12)
    simulation.restore(snapshot)
    assert drive(simulation, 5, 12) == went_on
    other = withy.Simulation(withy.loads(TURNTABLE).set("loads.command.hold", "linear"))
    other.restore(pickle.loads(pickle.dumps(snapshot)))
    assert drive(other, 5, 12) == went_on


def test_events_halt_a_simulation():
    scene = withy.loads(TURNTABLE + "events: {there: {hinge: axle, value: 0.5, stop: true}}\n")
    simulation = withy.Simulation(scene)
    simulation.inputs["command"] = 0.2
    assert not simulation.advance_to(2.0)
    assert simulation.time == pytest.approx(1, abs=1e-9)
    assert simulation.events[0][0] == "there" and simulation.events[0][2] == 1
    simulation.step(2.0)
    assert simulation.outputs["axle"] == pytest.approx(2, abs=1e-9)


def test_events_are_read_while_another_thread_steps():
    scene = withy.loads("""
format: withy/1
bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 1000}}
events: {passes_the_middle: {hinge: slide, value: 0}}
initial: {hinges: {slide: {position: [0.1]}}}
""")
    simulation = withy.Simulation(scene)
    over = threading.Event()
    seen = set()

    def watch():
        while not over.is_set():
            seen.update(event[0] for event in simulation.events)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        for k in range(1, 400):
            simulation.step(0.1 * k)
    finally:
        over.set()
        watcher.join()
    assert seen <= {"passes_the_middle"} and simulation.events


def test_what_cannot_go_on_says_why(slew):
    simulation = withy.Simulation(slew.set("loads.slew.time_scale", 1.2).set("formulation", "consistent"))
    with pytest.raises(withy.SimulationStopped, match="mass matrix") as stopped:
        simulation.step(3.0)
    assert stopped.value.status == "singular"
    assert stopped.value.time == simulation.time < 3
    assert pickle.loads(pickle.dumps(stopped.value)).time == stopped.value.time
    for again in (lambda: simulation.step(3.0), lambda: simulation.advance_to(4.0), simulation.snapshot):
        with pytest.raises(withy.SimulationStopped, match="mass matrix") as same:
            again()
        assert (str(same.value), same.value.status, same.value.time) == (str(stopped.value), "singular", simulation.time)


def test_equations_are_for_any_integrator(slew):
    scene = slew.set("integrator", {"name": "dop853", "rtol": 1e-11, "atol": 1e-13})
    equations = scene.compile("quadratic")
    y = equations.y0
    assert len(equations.names) == len(y) == len(equations.units)
    for k in range(400):
        y = rk4(equations.derivatives, 0.00025 * k, y, 0.00025)
    simulation = withy.Simulation(scene)
    simulation.step(0.1)
    for name, value in zip(equations.names, y):
        assert value == pytest.approx(simulation.outputs[name], abs=1e-7), name
    jacobian = equations.jacobian(0.1, y)
    for j in range(len(y)):
        h = 1e-5
        moved = [y + s * h * numpy.eye(len(y))[j] for s in (1, -1)]
        column = (equations.derivatives(0.1, moved[0]) - equations.derivatives(0.1, moved[1])) / (2 * h)
        assert numpy.abs(column - jacobian[:, j]).max() < 1e-5 * (1 + numpy.abs(jacobian).max())
    with pytest.raises(ValueError, match="need an array of"):
        equations.derivatives(0.0, y[:-1])
    with pytest.raises(withy.SimulationStopped):
        equations.derivatives(0.0, numpy.full(len(y), numpy.nan))


def test_equations_say_what_was_wrong_with_an_array(slew):
    equations = slew.compile("quadratic")
    for call in (lambda y: equations.derivatives(0, y), lambda y: equations.jacobian(0, y), equations.normalize):
        with pytest.raises(ValueError, match=f"need an array of {len(equations.y0)} numbers"):
            call(equations.y0[1:])
    for call in (equations.derivatives, equations.jacobian):
        with pytest.raises(withy.SimulationStopped, match="t = 0 s"):
            call(0, numpy.nan * equations.y0)


@pytest.mark.parametrize("formulation", ["quadratic", "consistent"])
def test_many_states_are_evaluated_as_each_alone(slew, formulation):
    equations = slew.compile(formulation)
    noise = numpy.random.default_rng(3).normal(size=(1003, len(equations.y0)))
    states = equations.y0 + 0.01 * noise
    many = equations.derivatives_many(0.1, states)
    for k in range(0, len(states), 7):
        assert numpy.array_equal(many[k], equations.derivatives_many(0.1, states[k : k + 1])[0])
        assert many[k] == pytest.approx(equations.derivatives(0.1, states[k]), rel=1e-9, abs=1e-9)
    assert equations.derivatives_many(0.1, states[:0]).shape == (0, len(equations.y0))
    with pytest.raises(ValueError, match="need an array of rows of"):
        equations.derivatives_many(0.1, states[0])
    states[17] = numpy.nan
    with pytest.raises(withy.SimulationStopped, match="row 17: "):
        equations.derivatives_many(0.1, states)


def test_scipy_integrates_the_equations():
    integrate = pytest.importorskip("scipy.integrate")
    equations = withy.loads(TURNTABLE).compile()
    equations.inputs["command"] = 0.2
    for method in ("RK45", "Radau"):
        jac = {} if method == "RK45" else {"jac": equations.jacobian}
        solution = integrate.solve_ivp(equations.derivatives, (0, 1), equations.y0, method, rtol=1e-8, **jac)
        assert solution.y[:, -1] == pytest.approx([0.5, 1], abs=1e-6)


def test_threads_give_the_bits_of_one(slew):
    equations = slew.compile()

    def walk(_):
        y = equations.y0
        for k in range(300):
            y = rk4(equations.derivatives, 0.001 * k, y, 0.001)
        return y

    def run(_):
        return slew.copy().run(time={"end": 0.3}).table

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for job in (walk, run):
            first, *others = pool.map(job, range(4))
            assert all(numpy.array_equal(first, other) for other in others)
