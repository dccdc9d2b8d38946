"""Scenes as text."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

_SECTIONS = ("bodies", "hinges", "loads", "motions", "outputs", "events", "constraints")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_./-]*")
_MEANT = {"true", "false", "yes", "no", "on", "off", "null", "y", "n"}


def _scalar(value: Any) -> str:
    if isinstance(value, str):
        return value if _PLAIN.fullmatch(value) and value.lower() not in _MEANT else json.dumps(value, ensure_ascii=False)
    if isinstance(value, float) and value != value or value in (float("inf"), -float("inf")):
        return {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}[str(value)]
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value)) if value or str(value)[0] != "-" else "-0.0"
    return json.dumps(value)


def _flow(value: Any) -> str:
    """On one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_scalar(k)}: {_flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _scalar(value)


def written(values: Mapping[str, Any], indent: str = "") -> str:
    """A scene as YAML: a line for each member that fits on one, and for each of a section."""
    text = ""
    for key, value in values.items():
        line = f"{indent}{_scalar(key)}: {_flow(value)}"
        if isinstance(value, Mapping) and value and (len(line) > 120 or not indent and key in _SECTIONS):
            line = f"{indent}{_scalar(key)}:\n{written(value, indent + '  ').rstrip()}"
        text += line + "\n"
    return text
