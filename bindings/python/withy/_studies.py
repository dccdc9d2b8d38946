"""Studies of scenes."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy

from . import _withy
from ._library import as_list, encoded
from ._parts import plain
from ._result import Result, name_in_csv

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Progress = Callable[[float, float], Any]
Path = Union[str, "os.PathLike[str]"]
Source = tuple[Union[str, bytes], Union[str, None]]
At = Union[Path, Mapping[str, Any], None]
Table = Union[Path, Mapping[str, "ArrayLike"]]
Number = Union[float, str]


def read_json(text: str) -> dict[str, Any]:
    """An object that the engine wrote."""
    values: dict[str, Any] = json.loads(text)
    return values


def _state(at: At) -> Source:
    """A state: the name of its file, or its text with a name for messages."""
    if at is None:
        return "", None
    if isinstance(at, Mapping):
        return "at", json.dumps(plain(at))
    return encoded(at), None


def _numbers(column: ArrayLike) -> NDArray[numpy.float64]:
    """A column as floats: what is masked was not measured, as what is nan."""
    values: NDArray[numpy.float64] = numpy.array(column, float)
    if isinstance(column, numpy.ma.MaskedArray):
        values[getattr(column, "mask")] = numpy.nan  # its own types know no masks
    return values


def _table(name: str, table: Table) -> Source:
    """A table: the name of its file, or its text with a name for messages."""
    if not hasattr(table, "items"):  # those of pandas are no mappings
        return encoded(table), None
    columns = {head: _numbers(column) for head, column in table.items()}
    if isinstance(table, Result):  # in files brackets hold units alone
        columns = {name_in_csv(head): column for head, column in columns.items()}
    shapes = {column.shape for column in columns.values()}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        raise ValueError(f"{name}: need columns of one length, got the shapes "
                         + ", ".join(f"{head}: {column.shape}" for head, column in columns.items()))
    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(columns)
    rows.writerows(zip(*(column.tolist() for column in columns.values())))
    return name, text.getvalue()


def _number(value: Number) -> str:
    """As a command line has it: a text stays as it is, with its unit."""
    return value if isinstance(value, str) else repr(float(value))


def _assigned(given: Mapping[str, Number] | Sequence[str]) -> list[str]:
    """``name=value``, as the command line has them."""
    if isinstance(given, Mapping):
        return [f"{name}={_number(value)}" for name, value in given.items()]
    return as_list(given)


def _bounded(given: Mapping[str, Any] | Sequence[str]) -> list[str]:
    """``path=low..high``, as the command line has them."""
    if not isinstance(given, Mapping):
        return as_list(given)
    texts = []
    for path, bounds in given.items():
        if bounds is not None and not isinstance(bounds, str):
            bounds = "..".join("" if bound is None else _number(bound) for bound in bounds)
        texts.append(f"{path}={bounds}" if bounds and bounds != ".." else path)
    return texts


def _with_matrices(system: dict[str, Any], states: int, inputs: int, outputs: int) -> dict[str, Any]:
    """Its matrices as arrays: of one without elements, as B where nothing drives the scene, text has no shape."""
    for name, rows, columns in (("A", states, states), ("B", states, inputs), ("C", outputs, states),
                                ("D", outputs, inputs)):
        system[name] = numpy.array(system[name], float).reshape(rows, columns)
    return system


class Studies:
    """What can be asked of a scene beside its runs."""

    @property
    def _made(self) -> _withy.Scene:
        raise NotImplementedError

    def compare(self, formulations: Sequence[str] | None = None, reference: str = "quadratic", *,
                outputs: Sequence[str] = (),
                progress: Progress | None = None) -> dict[str, Any]:
        """Runs several formulations: what ``withy compare --json`` prints, each run with its distance to the reference.

        Args:
            formulations: of ruthless, inconsistent, consistent and quadratic those that can treat the scene where left
                out; "left_out" has the others, each with the reason.
            outputs: what errors are measured on, as in `advise`; the usual ones where left out.

        Raises:
            SceneError: where the scene, or what is asked of it, cannot be.
        """
        return read_json(self._made.compare(as_list(formulations or ()), reference, as_list(outputs), progress))

    def trade(self, *, outputs: Sequence[str] = (), formulations: Sequence[str] = (), families: Sequence[str] = (),
              modes: Sequence[int] = (), integrators: Sequence[str] = (), tolerances: Sequence[float] = (),
              jobs: int = 0, progress: Progress | None = None) -> dict[str, Any]:
        """Error against cost over the product of the axes: what ``withy trade --json`` prints.

        Args:
            outputs: what errors are measured on, as in `advise`; the usual ones where left out.
            jobs: threads; 0: all.

        Raises:
            SceneError: where the scene, or what is asked of it, cannot be.
        """
        return read_json(self._made.trade(as_list(outputs), as_list(formulations), as_list(families), as_list(modes),
                                          as_list(integrators), as_list(tolerances), jobs, progress))

    def advise(self, accuracy: str | float, outputs: Sequence[str] = (), *, formulations: Sequence[str] = (),
               families: Sequence[str] = (), modes: Sequence[int] = (), integrators: Sequence[str] = (),
               tolerances: Sequence[float] = (), seconds: float | None = None,
               progress: Progress | None = None) -> dict[str, Any]:
        """The cheapest model that holds an accuracy: what ``withy advise --json`` prints; "advice" is None where there
        is none.

        Args:
            accuracy: a share (0.01 or ``"1%"``), a length or an angle (``"1 mm, 0.1 deg"``).
            outputs: what it is asked of: hinges, ``"link1.tip"``, ``"link1.tip.deflection"``; all where left out.
            seconds: of CPU time that the search may take; where left out 20 times that of the scene's run in
                ``quadratic``, or 10 s if that is more.

        Raises:
            SceneError: where the scene, or what is asked of it, cannot be.
        """
        return read_json(self._made.advise(str(accuracy), as_list(outputs), as_list(formulations), as_list(families),
                                           as_list(modes), as_list(integrators), as_list(tolerances), seconds,
                                           progress))

    def modes(self, lock: Sequence[str] = (), *, at: At = None, spin: Mapping[str, Number] | Sequence[str] = (),
              sweep: str = "", count: int = 6, as_is: bool = False, floquet: bool = False,
              blades: Sequence[str] | None = None, period: float = 0, effective_mass: bool = False,
              damp: Sequence[Number] = (), progress: Progress | None = None) -> dict[str, Any]:
        """Natural modes about the steady state: an element of "runs" of ``withy modes --json``.

        ``formulation`` and ``points``, an element for each value of the sweep with its ``modes``; ``against_next`` says
        by how much the next formulation up differs.

        Args:
            lock: hinges that are held, or single speeds of them.
            at: a state in the form of ``initial`` in a scene, as a dict (``result.final``) or the name of a file; the
                search for the steady state begins there. The scene's initial state where left out.
            spin: rates that hinges are held at [rad/s, m/s], by their names, or texts with units:
                ``{"axle": "60 rev/min"}``; ``"axle=6"`` as on the command line.
            sweep: ``"PATH=FROM:TO:COUNT"``: any number of the scene, or ``spin.HINGE``, over a range.
            count: lowest frequencies that are set against the next formulation up; 0: none, in less time.
            as_is: about the state as it is given, without finding the steady one.
            floquet: characteristic exponents over a whole turn, "floquet" in "turn" of a point, or "problem" there.
            blades: names of equal blades that are seen from where the rotor does not turn, or ``"auto"``: "multiblade"
                in "turn", or "blade_problem" there.
            period: of motions and loads [s]; 0: that of the hinges' rates.
            effective_mass: adds "effective_mass", how much of the mass [kg] each mode moves where the base shakes.
            damp: ratios that the lowest vibrations shall have (0.01, ``"1%"``): adds "damping", with values for
                Scene.set().

        Raises:
            SceneError: where the scene, or what is asked of it, cannot be. That a point has no modes is its "problem".
            OSError: where the file of a state cannot be read.
        """
        return read_json(self._made.modes(as_list(lock), _state(at), _assigned(spin), sweep, count, as_is, floquet,
                                          None if blades is None else as_list(blades), period, effective_mass,
                                          [_number(ratio) for ratio in as_list(damp)], progress))

    def linearize(self, inputs: Sequence[str] = (), outputs: Sequence[str] = (), lock: Sequence[str] = (), *,
                  at: At = None, spin: Mapping[str, Number] | Sequence[str] = ()) -> dict[str, Any]:
        """The linear model of small motions about a state: what ``withy linearize`` prints, with arrays "A" [states,
        states], "B" [states, inputs], "C" [outputs, states], "D" [outputs, inputs].

        Args:
            inputs: loads of type ``input``, hinges whose efforts are inputs, or ``"all"``; the scene's inputs or, where
                it has none, every hinge where left out.
            outputs: names or their beginnings; the scene's where left out, or all.
            lock: hinges that are held.
            at: the state, as in `modes`; the scene's initial one where left out. ``equilibrium()["state"]`` is one.
            spin: rates that hinges are held at [rad/s, m/s], as in `modes`.

        Raises:
            SimulationStopped: where the mass matrix of what is free is singular, or something is not finite; from what
                a load in Python raised.
            SceneError: where the scene, or what is asked of it, cannot be.
            OSError: where the file of a state cannot be read.
        """
        linear = read_json(self._made.linearize(as_list(inputs), as_list(outputs), as_list(lock), _state(at),
                                                _assigned(spin)))
        return _with_matrices(linear, *(len(linear[of]) for of in ("states", "inputs", "outputs")))

    def response(self, input: str, output: str = "", *, lock: Sequence[str] = (), at: At = None,
                 spin: Mapping[str, Number] | Sequence[str] = (), from_: float | None = None, to: float | None = None,
                 points: int = 100, reduce: int | None = None) -> dict[str, Any]:
        """The transfer function from an input to an output: what ``withy response --json`` prints, with "hertz" [n]
        and complex "values" [n] as arrays, in the unit of the output over that of the input.

        ``poles``, ``zeros`` and ``peaks``, the ``margins`` of the loop and, with ``reduce``, "reduction" with the
        matrices A to D as arrays.

        Args:
            input: a load of type ``input`` or a hinge; or a load that feeds back, or ``"LOAD.HINGE"``, whose loop is
                opened.
            output: one component of an output (``"imu.x"``), a coordinate (``"elbow.0"``) or tip (``"link2.tip.y"``),
                of outputs that the scene does not define too; left out where a loop is opened.
            lock: hinges that are held.
            at: the state, as in `modes`; the scene's initial one where left out.
            spin: rates that hinges are held at [rad/s, m/s], as in `modes`.
            from_: lowest frequency [Hz]; a decade below all poles where left out.
            to: highest frequency [Hz]; a decade above all poles, or half the samples' rate where left out.
            points: frequencies a decade, 5 to 100000; more where a resonance is sharp.
            reduce: states of a reduced system by balanced truncation, with the bound of its error.

        Raises:
            SimulationStopped: where the mass matrix of what is free is singular, or something is not finite.
            SceneError: where the scene, or what is asked of it, cannot be; where the output does not feel the input.
            OSError: where the file of a state cannot be read.
        """
        found = read_json(self._made.response(input, output, as_list(lock), _state(at), _assigned(spin), from_, to,
                                              points, reduce))
        rows = numpy.array(found["values"], float).reshape(-1, 3)
        found["hertz"], found["values"] = rows[:, 0].copy(), rows[:, 1] + 1j * rows[:, 2]
        if found["reduction"] is not None:
            _with_matrices(found["reduction"], found["reduction"]["states"], 1, 1)
        return found

    def equilibrium(self, lock: Sequence[str] = (), *, at: At = None,
                    spin: Mapping[str, Number] | Sequence[str] = ()) -> dict[str, Any]:
        """The state that stays as it is, at rest or spinning steadily: what ``withy equilibrium --json`` prints.

        "converged" is False where none is found, and "message" then says why. "state" is for ``at=`` of other studies
        and for ``scene.set("initial", ...)``; "efforts" are those that hold what is held [N m, N]; "tip_deflections"
        arrays [3] along the axes of each flexible body [m]; "stability" says what small motions do.

        Args:
            lock: hinges that are held, or single speeds of them.
            at: where the search begins, as in `modes`; the scene's initial state where left out.
            spin: rates that hinges are held at [rad/s, m/s], as in `modes`.

        Raises:
            SimulationStopped: where something is not finite.
            SceneError: where the scene, or what is asked of it, cannot be.
            OSError: where the file of a state cannot be read.
        """
        found = read_json(self._made.equilibrium(as_list(lock), _state(at), _assigned(spin)))
        found["tip_deflections"] = {tip: numpy.array(by, float) for tip, by in found["tip_deflections"].items()}
        return found

    def inverse(self, motion: Table | None = None, *, progress: Progress | None = None) -> dict[str, Any]:
        """Efforts that driven hinges need to follow their motions, flexible bodies swinging along: what ``withy inverse
        --json`` prints, with histories.

        "t" has the times of the outputs [n] in s; each of "drives" arrays "effort" [n] in N m or N, its "unit", and
        "rate" [n] in rad/s or m/s beside its peaks; "run" is the Result of the simulation. A bad end is its status.

        Args:
            motion: hinge coordinates over time in the place of the scene's motions: the name of a CSV file with columns
                ``t[s]`` and those of hinges, or a dict of arrays [m]: ``{"t": t, "shoulder[deg]": angles}``, in SI
                units where a name has none; a Result, or a DataFrame, is one too. Cubic splines go through the rows.
            progress: called with the time reached and the end [s].

        Raises:
            SceneError: where the scene, or the motion, cannot be, or no hinge is driven.
            ValueError: where columns have different lengths.
        """
        text, t, drives, run = self._made.inverse(("", None) if motion is None else _table("motion", motion), progress)
        found = read_json(text)
        found["t"] = t
        for name, effort, rate in drives:
            found["drives"][name]["effort"], found["drives"][name]["rate"] = effort, rate
        found["run"] = Result(*run)
        return found

    def tune(self, parameters: Mapping[str, Any] | Sequence[str], match: Table, *, outputs: Sequence[str] = (),
             deviations: Mapping[str, Number] | Sequence[str] = (), starts: int = 1, seed: int = 1, jobs: int = 0,
             progress: Progress | None = None) -> dict[str, Any]:
        """Fits values of the scene to measured data: what ``withy tune --json`` prints, with histories. The scene stays
        as it is: "changes" has the fitted values by their paths, for Scene.set().

        "converged" is False where the search has not come to an end, and "trouble" says why where there is no fit at
        all. "correlation" [k, k] and "singular_values" [k] of the k values that are fitted are arrays, "t" are the
        times of the data [n] in s; each of "columns" has "measured" [n], nan where nothing was measured, and the
        scene's run "before" [n] (None where it fails) and "fitted" [n], in its "unit".

        Args:
            parameters: paths of numbers of the scene that are fitted, beginning at its values, with bounds as on the
                command line (``"bodies.rod.mass=1..2"``), or a dict of them, ``{"bodies.rod.mass": (1, "2 kg")}``, in
                SI units where a bound has none; None: without.
            match: measured data: the name of a CSV file with a head as ``t[s],tip.x[mm]``, or a dict of arrays [n] by
                such names, those of the columns of a Result, in SI units where a name has none; a Result, or a
                DataFrame, is one too. nan where nothing was measured.
            outputs: columns of the data that are compared; all that results have where left out.
            deviations: standard deviations of the measurement by names, in SI units or with a unit:
                ``{"tip.x": "0.1 mm"}``; columns weigh by their ranges where left out.
            starts: searches: from the scene's values, others from within the bounds.
            seed: of the starts.
            jobs: runs at once; 0: one a core.
            progress: called with the starts done and all starts.

        Raises:
            SceneError: where the scene, the parameters or the data cannot be: all that is wrong.
            ValueError: where columns have different lengths.
        """
        data, text = _table("match", match)
        fit, t, columns, changes = self._made.tune(_bounded(parameters), data, text, as_list(outputs),
                                                   _assigned(deviations), starts, seed, jobs, progress)
        found = read_json(fit)
        fitted = len(found["correlation"])
        found["correlation"] = numpy.array(found["correlation"], float).reshape(fitted, fitted)
        found["singular_values"] = numpy.array(found["singular_values"], float)
        found["t"] = t
        for column, histories in zip(found["columns"], columns):
            column["measured"], column["before"], column["fitted"] = histories
        found["changes"] = dict(changes)
        return found
