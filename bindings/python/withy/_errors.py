"""The exceptions of the package."""

from __future__ import annotations

from typing import Any


class SceneError(ValueError):
    """A scene, a value set in it, or what is asked of a study cannot be.

    The text names every problem with its place, as ``arm.yaml:66:14: /bodies/boom/length: got -1 m; need > 0``.
    """


class PluginError(RuntimeError):
    """A library of plugins that a scene names is refused; the text says which and why."""


class StoreError(RuntimeError):
    """The folder of a sweep holds something else, is damaged, or another process writes what was asked of this one."""


class SimulationStopped(RuntimeError):
    """A simulation cannot go on; the text is the physical reason.

    Attributes:
        status: as in run.json: ``diverged``, ``singular``, ``step-underflow``, ``interrupted``, ``load-failed`` or
            ``too-stiff``.
        time: of the last accepted state [s], where the simulation stands.
        __cause__: what a load written in Python raised, where that is the reason.
    """

    def __init__(self, message: str, status: str = "", time: float = 0.0) -> None:
        super().__init__(message)
        self.status = status
        self.time = time

    def __reduce__(self) -> tuple[Any, ...]:  # pickled with its attributes
        return type(self), (str(self), self.status, self.time)
