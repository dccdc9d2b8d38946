"""Dynamics of trees of rigid and flexible bodies::

    import withy
    scene = withy.load("arm.yaml")
    result = scene.set("loads.slew.time_scale", 1.2).run()
    result.plot("link1.tip.deflection_y")

Numbers are in SI units: rad, m, s, N, N m. Errors of scenes are SceneError with every problem and its place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping
from typing import TYPE_CHECKING, Any

from . import _withy
from ._errors import PluginError, SceneError, SimulationStopped, StoreError
from ._foreign import python_body, python_load
from ._parts import Parts, parts, shortcuts
from ._result import Result, nearest, places_of, unknown
from ._scene import Scene, load, loads
from ._sweep import SweepResult, sweep
from ._withy import Snapshot

if TYPE_CHECKING:  # made from the plugins when the module is built
    from ._shortcuts import *  # noqa: F403

__all__ = ["Equations", "Parts", "PluginError", "Result", "Scene", "SceneError", "Simulation", "SimulationStopped", "Snapshot",
           "StoreError", "SweepResult", "load", "loads", "parts", "python_body", "python_load", "sweep"]

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Functions that make parts of scenes, which are made when the first is asked for."""
        if not name.startswith("_") and name in (made := shortcuts()):
            return made[name]
        known = [] if name.startswith("_") else [*__all__, *made]
        raise AttributeError(f"module 'withy' has no {name!r}" + (nearest(name, known) if known else ""))


class _Names:
    """The names of a list of numbers, with their places in it and their units."""

    def __init__(self, what: str, names: list[str], units: list[str]) -> None:
        self.what = what
        self.index, self._of_csv = places_of(names)
        self.units = dict(zip(names, units))

    def at(self, name: str) -> int:
        index = self.index.get(name, self._of_csv.get(name))
        if index is None:
            raise unknown(self.what, name, list(self.index))
        return index


class _Ports(Mapping[str, float]):
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


class _Inputs(_Ports, MutableMapping[str, float]):
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
