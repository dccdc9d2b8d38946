"""Dynamics of trees of rigid and flexible bodies.

    import withy
    scene = withy.load("arm.yaml")
    result = scene.set("loads.slew.time_scale", 1.2).run()
    result.plot("link1.tip.deflection_y")

Numbers are in SI units: rad, m, s, N, N m. Errors of scenes are SceneError with every problem and its place.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import Any, Union

from . import _withy
from ._errors import PluginError, SceneError, SimulationStopped, StoreError
from ._library import library
from ._result import Result, unknown
from ._sweep import SweepResult, sweep
from ._withy import Snapshot

__all__ = ["Equations", "PluginError", "Result", "Scene", "SceneError", "Simulation", "SimulationStopped", "Snapshot",
           "StoreError", "SweepResult", "load", "loads", "sweep"]

Progress = Callable[[float, float], Any]
Path = Union[str, "os.PathLike[str]"]

def load(path: Path, plugins: Sequence[Path] = ()) -> Scene:
    """Reads a scene from a file, YAML or JSON.

    Args:
        path: of the file.
        plugins: folders with plugins of your own.

    Raises:
        SceneError: where the text cannot be read.
        OSError: where the file cannot.
    """
    name = os.fspath(path)
    return Scene(_withy.Scene.read(library(plugins), name), tuple(os.fspath(p) for p in plugins))


def loads(text: str, name: str = "scene", plugins: Sequence[Path] = ()) -> Scene:
    """Reads a scene from its text. ``name`` stands for the file in messages; names of other files begin at its folder."""
    return Scene(_withy.Scene.parse(library(plugins), text, name), tuple(os.fspath(p) for p in plugins))


def _as_text(value: Any) -> str:
    """A value as a scene's file has it; a text stays as it is: "25 mm", "quadratic"."""
    if isinstance(value, str):
        return value
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    return json.dumps(value, allow_nan=True)


class Scene:
    """A scene: read, varied, run and studied. Make it with load() or loads(); it can be copied and pickled.

    What is set is checked when the scene is needed: every problem is then reported at once, as SceneError.
    """

    def __init__(self, made: _withy.Scene, plugins: tuple[str, ...] = ()) -> None:
        self._made = made
        self._plugins = plugins

    def set(self, path: str, value: Any) -> Scene:
        """Changes a value.

        Args:
            path: keys with dots between them, as ``"loads.slew.time_scale"`` or ``"gravity.1"``.
            value: a number in SI units, a text as in a file (``"25 mm"``), a list, a dict, a NumPy array, or None.

        Returns:
            The scene itself, so that calls can follow each other.
        """
        self._made.set(path, _as_text(value))
        return self

    def copy(self) -> Scene:
        """A scene of its own that says the same."""
        return Scene(self._made.copy(), self._plugins)

    __copy__ = copy

    def __deepcopy__(self, memo: dict) -> Scene:
        return self.copy()

    def __reduce__(self):
        return _restored, (self._made.text, self._made.name, self._plugins, list(self._made.changes))

    def __repr__(self) -> str:
        changes = "".join(f", {change}" for change in self._made.changes)
        return f"<withy.Scene {self._made.name}{changes}>"

    def check(self) -> None:
        """Raises SceneError with every problem where the scene has any."""
        self._made.check()

    def run(self, *, progress: Progress | None = None, **options: Any) -> Result:
        """Simulates to the end of the scene. A bad end is a status of the result, not an exception.

        Args:
            progress: called with the time reached and the end [s].
            options: values of the scene for this run alone: ``formulation="exact"``, ``integrator={"name": "rk4",
                "step": 1e-3}``, ``time={"end": 2}``.
        """
        return Result(*self._with(options)._made.run(progress))

    def compile(self, formulation: str | dict | None = None) -> Equations:
        """The equations of motion y' = f(t, y), for an integrator of your own.

        Args:
            formulation: its name, or a dict with options; the scene's where left out.
        """
        return Equations(self._with({} if formulation is None else {"formulation": formulation})._made, "")

    def compare(self, formulations: Sequence[str] = ("ruthless", "inconsistent", "consistent", "quadratic"),
                reference: str = "quadratic", *, progress: Progress | None = None) -> dict[str, Any]:
        """Runs several formulations: what ``withy compare --json`` prints, each run with its distance to the reference."""
        return json.loads(self._made.compare(list(formulations), reference, progress))

    def trade(self, *, formulations: Sequence[str] = (), families: Sequence[str] = (), modes: Sequence[int] = (),
              integrators: Sequence[str] = (), tolerances: Sequence[float] = (), jobs: int = 0,
              progress: Progress | None = None) -> dict[str, Any]:
        """Error against cost over the product of the axes: what ``withy trade --json`` prints. ``jobs`` threads; 0: all."""
        return json.loads(self._made.trade(list(formulations), list(families), list(modes), list(integrators),
                                           list(tolerances), jobs, progress))

    def advise(self, accuracy: str | float, outputs: Sequence[str] = (), *, formulations: Sequence[str] = (),
               families: Sequence[str] = (), modes: Sequence[int] = (), integrators: Sequence[str] = (),
               tolerances: Sequence[float] = (), progress: Progress | None = None) -> dict[str, Any]:
        """The cheapest model that holds an accuracy: what ``withy advise --json`` prints; "advice" is None where none does.

        Args:
            accuracy: a share (0.01 or ``"1%"``), a length or an angle (``"1 mm, 0.1 deg"``).
            outputs: what it is asked of: hinges, ``"link1.tip"``, ``"link1.tip.deflection"``; all where left out.
        """
        return json.loads(self._made.advise(str(accuracy), list(outputs), list(formulations), list(families),
                                            list(modes), list(integrators), list(tolerances), progress))

    def modes(self, lock: Sequence[str] = (), *, progress: Progress | None = None) -> dict[str, Any]:
        """Natural modes about the steady state, hinges in ``lock`` held: an element of "runs" of ``withy modes --json``."""
        return json.loads(self._made.modes(list(lock), progress))

    def _with(self, options: Mapping[str, Any]) -> Scene:
        if not options:
            return self
        changed = self.copy()
        for path, value in options.items():
            if isinstance(value, Mapping) and path not in ("formulation", "integrator"):
                for key, member in value.items():
                    changed.set(f"{path}.{key}", member)
            else:
                changed.set(path, value)
        return changed


def _restored(text: str, name: str, plugins: tuple[str, ...], changes: list[str]) -> Scene:
    scene = loads(text, name, plugins)
    for change in changes:
        path, _, value = change.partition("=")
        scene.set(path, value)
    return scene


class _Names:
    """The names of a list of numbers, with their places in it and their units."""

    def __init__(self, what: str, names: list[str], units: list[str]) -> None:
        self.what = what
        self.index = {name: i for i, name in enumerate(names)}
        self.units = dict(zip(names, units))

    def at(self, name: str) -> int:
        index = self.index.get(name)
        if index is None:
            raise unknown(self.what, name, list(self.index))
        return index


class _Ports(Mapping):
    """Numbers of a simulation by their names. Made at each access: a simulation that held it would hold itself."""

    def __init__(self, names: _Names, get: Callable[[int], float]) -> None:
        self._names, self._get = names, get

    @property
    def units(self) -> dict[str, str]:
        """SI units by the names."""
        return self._names.units

    def __getitem__(self, name: str) -> float:
        return self._get(self._names.at(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names.index)

    def __len__(self) -> int:
        return len(self._names.index)

    def __repr__(self) -> str:
        return repr(dict(self))


class _Inputs(_Ports, MutableMapping):
    """The same, to be set."""

    def __init__(self, names: _Names, get: Callable[[int], float], set_: Callable[[int, float], None]) -> None:
        super().__init__(names, get)
        self._set = set_

    def __setitem__(self, name: str, value: float) -> None:
        self._set(self._names.at(name), float(value))

    def __delitem__(self, name: str) -> None:
        raise TypeError("inputs of a scene cannot be taken away")


class Simulation(_withy.Simulation):
    """A simulation in steps: ``sim.inputs["command"] = 2.0; sim.step(0.1); sim.outputs["shoulder"]``."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene._made)
        self._input_list = _Names("input", self._input_names(), self._input_units())
        self._output_list = _Names("output", self._output_names(), self._output_units())

    @property
    def inputs(self) -> _Inputs:
        """Values of the loads of type ``input`` [N m, N], by their names.

        What is set acts from the next step on: at once, or with ``hold: linear`` in a straight line to its end.
        """
        return _Inputs(self._input_list, self._input, self._set_input)

    @property
    def outputs(self) -> _Ports:
        """The columns of results.csv at the present state, by their names."""
        return _Ports(self._output_list, self._output)


class Equations(_withy.Equations):
    """Equations of motion y' = f(t, y); made by Scene.compile(). y holds positions, then speeds [n].

    As a right-hand side: ``scipy.integrate.solve_ivp(eq.derivatives, (0, 1), eq.y0, method="Radau", jac=eq.jacobian)``.
    """

    def __init__(self, made: Any, formulation: str = "") -> None:
        super().__init__(made, formulation)
        self._input_list = _Names("input", self._input_names(), self._input_units())

    @property
    def inputs(self) -> _Inputs:
        """Values of the loads of type ``input`` [N m, N], by their names, for the evaluations to come."""
        return _Inputs(self._input_list, self._input, self._set_input)
