"""Scenes: read from files, or built in code."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from . import _withy
from ._library import encoded, folders, library
from ._parts import plain
from ._result import Result, unknown
from ._studies import Path, Progress, Studies, read_json
from ._yaml import written

if TYPE_CHECKING:
    from . import Equations


def load(path: Path, plugins: Sequence[Path] = (), *, check: bool = True) -> Scene:
    """Reads a scene from a file, YAML or JSON.

    Args:
        path: of the file.
        plugins: folders with plugins of your own.
        check: at once, as ``withy check`` does; False: when the scene is needed, for a text that set() is to complete.

    Raises:
        SceneError: where the text cannot be read or, checked, has any problem: all of them, each with its place.
        OSError: where the file cannot.
    """
    kept = folders(plugins)
    return _checked(_withy.Scene.read(library(kept), encoded(path)), kept, check)


def loads(text: str, name: str = "scene", plugins: Sequence[Path] = (), *, check: bool = True) -> Scene:
    """Reads a scene from its text, as load() does. ``name`` stands for the file in messages; names of other files begin
    at its folder.

    Raises:
        SceneError: as load() does.
    """
    kept = folders(plugins)
    return _checked(_withy.Scene.parse(library(kept), text, encoded(name)), kept, check)


def _checked(made: _withy.Scene, plugins: Sequence[str], check: bool) -> Scene:
    if check:
        made.check()
    return Scene._of(made, plugins)


def _as_text(value: Any) -> str:
    """A value as a scene's file has it; a text stays as it is: "25 mm", "quadratic"."""
    if isinstance(value, str):
        return value
    return json.dumps(plain(value), allow_nan=True, ensure_ascii=False)


def _frozen(value: Any) -> Any:
    """To look at: what is changed in a copy would be lost unseen."""
    if isinstance(value, dict):
        return MappingProxyType({k: _frozen(v) for k, v in value.items()})
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


class _Section(MutableMapping[str, Any]):
    """The parts of a scene by their names. What it gives can be looked at; assign anew, or use Scene.set(), to change it."""

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name

    def _now(self) -> Mapping[str, Any]:
        return self._scene._values_now().get(self._name) or {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._now():
            raise unknown(f"member of {self._name}", name, list(self._now()))
        return _frozen(self._now()[name])

    def __setitem__(self, name: str, value: Mapping[str, Any]) -> None:
        self._scene._changing(self._name)[name] = plain(value)

    def __delitem__(self, name: str) -> None:
        self[name]  # KeyError with the nearest name
        del self._scene._changing(self._name)[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._now())

    def __len__(self) -> int:
        return len(self._now())

    def __repr__(self) -> str:
        return f"<{self._name}: {', '.join(self) or 'none'}>"


class Scene(Studies):
    """A scene: read, built in code, varied, run and studied. It can be copied and pickled.

    ``Scene()`` is empty: ``scene.bodies["boom"] = withy.beam(...)``; load() and loads() read one. What is set is checked
    when the scene is needed: every problem is then reported at once, as SceneError. The lines that it names are those of
    the file or, of a scene built or changed in code, of to_yaml().

    Args:
        plugins: folders with plugins of your own.
        values: members of the scene, as a file has them: ``gravity=[0, 0, -9.81]``, ``time={"end": 4}``.
    """

    def __init__(self, *, plugins: Sequence[Path] = (), **values: Any) -> None:
        self._plugins: tuple[str, ...] = folders(plugins)
        self._name = "scene"
        self._folder = ""  # where names of files begin: of what was read, or the working folder when it was needed first
        self._read: _withy.Scene | None = None
        # While it is built in code: what it says. Else the engine's scene knows.
        self._values: dict[str, Any] | None = {"format": "withy/1", **{k: plain(v) for k, v in values.items()}}

    @classmethod
    def _of(cls, made: _withy.Scene, plugins: Sequence[str]) -> Scene:
        scene = cls(plugins=plugins)
        scene._name, scene._folder, scene._read, scene._values = made.name, made.folder, made, None
        return scene

    @property
    def _made(self) -> _withy.Scene:
        """The engine's scene, anew after a change in code."""
        if self._read is None:
            self._read = _parsed(self.to_yaml(), self._name, self._plugins, self._folder)
            self._folder = self._read.folder
        return self._read

    def _values_now(self) -> dict[str, Any]:
        if self._values is None:
            self._values = read_json(self._made.values)
        return self._values

    def _changing(self, section: str) -> dict[str, Any]:
        """The members of a section, to be changed; lines of the file that was read are no longer those of the scene."""
        values = self._values_now()
        if self._read is not None and not self._name.endswith("to_yaml()") and self._name != "scene":
            self._name += ", to_yaml()"
        self._read = None
        if not isinstance(values.get(section), dict):
            values[section] = {}
        members: dict[str, Any] = values[section]
        return members

    @property
    def bodies(self) -> MutableMapping[str, Any]:
        """Bodies by their names: ``scene.bodies["boom"] = withy.beam(length=8, ...)``."""
        return _Section(self, "bodies")

    @property
    def hinges(self) -> MutableMapping[str, Any]:
        """Hinges by their names: ``scene.hinges["root"] = withy.weld(parent="bus", child="boom")``."""
        return _Section(self, "hinges")

    @property
    def loads(self) -> MutableMapping[str, Any]:
        """Loads by their names: ``scene.loads["push"] = withy.force(...)``."""
        return _Section(self, "loads")

    @property
    def motions(self) -> MutableMapping[str, Any]:
        """Prescribed motions by their names: ``scene.motions["spin"] = withy.spin_up(hinge="axle", ...)``."""
        return _Section(self, "motions")

    @property
    def outputs(self) -> MutableMapping[str, Any]:
        """Outputs by their names: ``scene.outputs["imu"] = withy.accelerometer(of="bus")``."""
        return _Section(self, "outputs")

    @property
    def events(self) -> MutableMapping[str, Any]:
        """Events by their names, each a dict."""
        return _Section(self, "events")

    @property
    def constraints(self) -> MutableMapping[str, Any]:
        """Constraints by their names, each a dict."""
        return _Section(self, "constraints")

    def to_yaml(self) -> str:
        """The scene as a file has it, all that was set included: loads(scene.to_yaml()) says the same.

        Raises:
            SceneError: where what was set cannot be understood.
        """
        return written(self._values_now())

    def set(self, path: str, value: Any) -> Scene:
        """Changes a value.

        Args:
            path: keys with dots between them, as ``"loads.slew.time_scale"`` or ``"gravity.1"``.
            value: a number in SI units, a text as in a file (``"25 mm"``), a list, a dict, a NumPy array, or None, which takes it away.

        Returns:
            The scene itself, so that calls can follow each other.

        Raises:
            TypeError: where the value is of another kind. What is wrong with it otherwise is said when the scene is needed.
        """
        self._made.set(path, _as_text(value))
        self._values = None
        return self

    def unset(self, path: str) -> Scene:
        """Takes back what set() has said of a value since parts of the scene were last assigned in code.

        Args:
            path: as set() was given it.

        Returns:
            The scene itself.

        Raises:
            KeyError: with the nearest path where set() has said nothing of this one.
        """
        paths = [change.partition("=")[0] for change in self._made.changes]
        if path not in paths:
            raise unknown("set value", path, paths)
        kept = [change for change, of in zip(self._made.changes, paths) if of != path]
        self._read = _restored(self._made.text, self._made.name, self._plugins, kept, self._made.folder)._made
        self._values = None
        return self

    def copy(self) -> Scene:
        """A scene of its own that says the same."""
        return Scene._of(self._made.copy(), self._plugins)

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._made.text, self._made.name, self._plugins, list(self._made.changes), self._made.folder)

    def __repr__(self) -> str:
        changes = "".join(f", {change}" for change in self._made.changes)
        return f"<withy.Scene {self._made.name}{changes}>"

    def check(self) -> None:
        """What ``withy check`` does.

        Raises:
            SceneError: with every problem where the scene has any.
        """
        self._made.check()

    def run(self, *, progress: Progress | None = None, **options: Any) -> Result:
        """Simulates to the end of the scene. A bad end is a status of the result, not an exception.

        Args:
            progress: called with the time reached and the end [s].
            options: values of the scene for this run alone: ``formulation="exact"``, ``integrator={"name": "rk4",
                "step": 1e-3}``, ``time={"end": 2}``. Dicts change the members that they name, at any depth, and leave the
                others; one with ``type`` or ``name`` takes the place of what was there.

        Raises:
            SceneError: where the scene, with these values, cannot be.
            KeyboardInterrupt: at Ctrl-C, and what ``progress`` raises.
        """
        return Result(*self._with(options)._made.run(progress))

    def compile(self, formulation: str | dict[str, Any] | None = None) -> Equations:
        """The equations of motion y' = f(t, y), for an integrator of your own.

        Args:
            formulation: its name, or a dict with options; the scene's where left out.

        Raises:
            SceneError: where the scene cannot be, or has no such equations: loads that change at instants, ``auto``.
        """
        from . import Equations

        return Equations(self._with({} if formulation is None else {"formulation": formulation})._made, "")

    def _with(self, options: Mapping[str, Any]) -> Scene:
        if not options:
            return self
        changed = self.copy()
        for path, value in options.items():
            _set_members(changed, path, value)
        return changed


def _set_members(scene: Scene, path: str, value: Any) -> None:
    """Sets members one by one where they stand; a part that says what it is takes the place of what was there."""
    whole = path in ("formulation", "integrator")
    if isinstance(value, Mapping) and not whole and not {"type", "name"} & value.keys():
        for key, member in value.items():
            _set_members(scene, f"{path}.{key}", member)
    else:
        scene.set(path, value)


def _parsed(text: str, name: str, plugins: Sequence[str], folder: str) -> _withy.Scene:
    """Names of other files begin at the folder or, where it is empty, at that of the name as it is now."""
    if folder:
        return _withy.Scene.parse(library(plugins), text, encoded(name), encoded(folder))
    return _withy.Scene.parse(library(plugins), text, encoded(name))


def _restored(text: str, name: str, plugins: tuple[str, ...], changes: list[str], folder: str = "") -> Scene:
    scene = Scene._of(_parsed(text, name, plugins, folder), plugins)
    for change in changes:
        path, _, value = change.partition("=")
        scene.set(path, value)
    return scene
