"""What scenes are made of: a function for each plugin, made from what the plugin says of its parameters.

    scene.bodies["boom"] = withy.beam(length=8, mass_per_length=0.4, bending_y={"stiffness": 2e3, "modes": 2})

Every id that bodies, hinges, loads, motions and outputs have once is a function of the package, with ``_`` for ``-``; all
of them, and integrators and formulations, are also in ``withy.parts.bodies`` and so on. ``help(withy.beam)`` has the
parameters with their units. A function gives a dict, as a scene's file has it; the values are checked by the scene.
"""

from __future__ import annotations

import inspect
import json
import keyword
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from ._errors import SceneError
from ._library import folders, library
from ._result import nearest

SECTIONS = {"bodies": "type", "hinges": "type", "loads": "type", "motions": "type", "outputs": "type",
            "integrators": "name", "formulations": "name"}

_schemas: dict[tuple[str, ...], dict[str, Any]] = {}


def schema(plugins: Sequence[str] = ()) -> dict[str, Any]:
    """The JSON Schema of scenes, of all plugins there are: what ``withy schema`` prints. Libraries that are refused are
    left out, with a warning."""
    key = folders(plugins)
    if key not in _schemas:
        _schemas[key] = json.loads(library(key).schema())
    return _schemas[key]


def _variants(section: str, all_: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Ids and schemas of the plugins of a section."""
    properties = all_["properties"]
    of = properties[section[:-1]] if section[:-1] in properties else properties[section]["additionalProperties"]
    for variant in of["anyOf"]:
        if "properties" in variant:
            yield variant["properties"][SECTIONS[section]]["const"], variant


def python_name(key: str) -> str:
    """A key or an id as a name of Python: ``from_`` for ``from``, ``spin_up`` for ``spin-up``."""
    name = key.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def _resolved(of: dict[str, Any], all_: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in of:
        of = {**all_["$defs"][of["$ref"].rpartition("/")[2]], **of}
    if isinstance(of.get("type"), list):  # a map that may be nothing
        of = {**of, "type": next(kind for kind in of["type"] if kind != "null")}
    return of


def _form(of: dict[str, Any], all_: dict[str, Any]) -> str:
    """What a value looks like, in words."""
    of = _resolved(of, all_)
    if "enum" in of:
        return " or ".join(json.dumps(e) for e in of["enum"])
    if "anyOf" in of:
        forms = dict.fromkeys(_form(f, all_) for f in of["anyOf"] if "quantity" not in f.get("$ref", ""))
        return " or ".join(list(forms)[:4])
    if of.get("type") == "array":
        items = _resolved(of.get("items", {}), all_)
        if items.get("type") == "array":
            return f"rows of {items.get('minItems', 'any number')}"
        count = f"{of['minItems']} " if of.get("minItems") == of.get("maxItems") and "minItems" in of else ""
        return f"list of {count}{_form(items, all_)}s"
    limits = [f"> {of['exclusiveMinimum']:g}"] if "exclusiveMinimum" in of else []
    limits += [f">= {of['minimum']:g}"] if "minimum" in of else []
    limits += [f"<= {of['maximum']:g}"] if "maximum" in of else []
    named = {"object": "dict", "string": "text", "boolean": "bool"}.get(of.get("type", ""), of.get("type", "value"))
    return f"{named} {' and '.join(limits)}" if limits else named


def _described(key: str, of: dict[str, Any], required: bool, all_: dict[str, Any], indent: str) -> list[str]:
    """A parameter and, of a dict, its members: a line each."""
    whole = _resolved(of, all_)
    default = "required" if required else "optional"
    if not required and whole.get("default") not in (None, {}):
        default = "default " + re.sub(r"(\d)\.0\b", r"\1", json.dumps(whole["default"]))
    lines = [f"{indent}{key}: {of.get('description', whole.get('description', ''))}; {_form(of, all_)}, {default}"]
    members = whole.get("properties", {})
    for name, member in members.items():
        lines += _described(name, member, name in whole.get("required", ()), all_, indent + "    ")
    return lines


def _factory(section: str, id_: str, variant: dict[str, Any], all_: dict[str, Any]) -> Callable[..., dict[str, Any]]:
    chooser = SECTIONS[section]
    keys = {python_name(key): key for key in variant["properties"] if key != chooser}
    required = [python_name(key) for key in variant.get("required", ()) if key != chooser]

    def make(**values: Any) -> dict[str, Any]:
        for name in values:
            if name not in keys:
                raise SceneError(f"{id_}/{name}: unknown key \"{name}\"{nearest(name, list(keys))}")
        if lacking := [keys[name] for name in required if name not in values]:
            raise SceneError("\n".join(f"{id_}/{key}: missing; need {_form(variant['properties'][key], all_)}: "
                                       f"{variant['properties'][key].get('description', '')}" for key in lacking))
        return {chooser: id_, **{keys[name]: plain(value) for name, value in values.items() if value is not None}}

    make.__name__ = make.__qualname__ = python_name(id_)
    make.__module__ = "withy"
    lines = [f"{variant.get('description', id_)}.", "", "Args:"]
    for name, key in keys.items():
        lines += _described(name, variant["properties"][key], name in required, all_, "    ")
    lines += ["", "Raises:", "    SceneError: where a parameter is missing or unknown."]
    make.__doc__ = "\n".join(lines)
    make.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY) for name in required] +
        [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in keys if name not in required])
    return make


def plain(value: Any) -> Any:
    """A value as JSON has it: arrays of NumPy as lists, mappings as dicts."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "items"):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    return value


class Section:
    """The functions that make the parts of a section of scenes: ``withy.parts.loads.force``."""

    def __init__(self, name: str, plugins: Sequence[str] = ()) -> None:
        self._name, self._plugins = name, plugins
        self._made: dict[str, Callable[..., dict[str, Any]]] = {}

    def _all(self) -> dict[str, Callable[..., dict[str, Any]]]:
        if not self._made:
            all_ = schema(self._plugins)
            self._made = {python_name(id_): _factory(self._name, id_, variant, all_)
                          for id_, variant in _variants(self._name, all_)}
        return self._made

    def __getattr__(self, name: str) -> Callable[..., dict[str, Any]]:
        if name.startswith("_") or name not in self._all():
            raise AttributeError(f"no {name!r} among {self._name}{nearest(name, list(self._all()))}")
        return self._all()[name]

    def __dir__(self) -> list[str]:
        return list(self._all())


class Parts:
    """The parts of scenes, by their sections. ``Parts(plugins)`` has those of plugins of your own too."""

    def __init__(self, plugins: Sequence[str] = ()) -> None:
        kept = folders(plugins)
        self.bodies, self.hinges, self.loads, self.motions, self.outputs, self.integrators, self.formulations = (
            Section(name, kept) for name in SECTIONS)


parts = Parts()


_WITH_FUNCTIONS = ("bodies", "hinges", "loads", "motions", "outputs")


def _owners() -> dict[str, str]:
    """The section of each id that is a function of the package: those that one section alone has. What a load and a
    motion share is the load's."""
    found: dict[str, list[str]] = {}
    for section in _WITH_FUNCTIONS:
        for name in getattr(parts, section)._all():
            found.setdefault(name, []).append(section)
    return {name: in_[0] for name, in_ in found.items() if len(in_) == 1 or in_ == ["loads", "motions"]}


def shortcuts() -> dict[str, Callable[..., dict[str, Any]]]:
    """Those that are functions of the package."""
    return {name: getattr(parts, section)._all()[name] for name, section in _owners().items()}


def _type(of: dict[str, Any], all_: dict[str, Any]) -> str:
    """The type of a value, for type checkers."""
    of = _resolved(of, all_)
    if "enum" in of:
        return f"Literal[{', '.join(map(repr, of['enum']))}]"
    if "anyOf" in of:
        return " | ".join(dict.fromkeys(_type(f, all_) for f in of["anyOf"]))
    if of.get("type") == "array":
        return f"Sequence[{_type(of['items'], all_)}] | NDArray[Any]" if "items" in of else "Sequence[Any]"
    return {"object": "Mapping[str, Any]", "string": "str", "boolean": "bool", "number": "float",
            "integer": "int"}.get(of.get("type", ""), "Any")


def write_stub(file: str) -> None:
    """Writes the types of all functions for type checkers: the module _shortcuts, which is never imported."""
    all_ = schema()
    lines = ['"""Functions that make parts of scenes: written by withy._parts from the plugins."""', "",
             "from collections.abc import Mapping, Sequence", "from typing import Any, Literal", "",
             "from numpy.typing import NDArray", ""]
    owners = _owners()
    for section in _WITH_FUNCTIONS:
        for id_, variant in _variants(section, all_):
            if owners.get(python_name(id_)) != section:
                continue
            required = [k for k in variant.get("required", ()) if k != "type"]
            optional = [k for k in variant["properties"] if k != "type" and k not in required]
            given = [f"{python_name(k)}: {_type(variant['properties'][k], all_)}" for k in required]
            given += [f"{python_name(k)}: {_type(variant['properties'][k], all_)} | None = ..." for k in optional]
            lines.append(f"def {python_name(id_)}({', '.join(['*', *given]) if given else ''}) -> dict[str, Any]: ...")
    with open(file, "w", encoding="utf-8") as out:
        out.write("\n".join(lines) + "\n")
