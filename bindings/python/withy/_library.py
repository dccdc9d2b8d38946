"""The plugins of the process."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Sequence
from typing import TypeVar, Union, cast

from . import _withy

_T = TypeVar("_T")

_libraries: dict[tuple[str, ...], _withy.Library] = {}


def as_list(several: Iterable[_T]) -> list[_T]:
    """A text alone is a list of one, and not of its letters."""
    return [cast(_T, several)] if isinstance(several, str) else list(several)


def encoded(path: Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]) -> bytes:
    """The name of a file as the system has it: one that is not UTF-8 too."""
    return os.fsencode(path)


def folders(plugins: Iterable[Union[str, "os.PathLike[str]"]]) -> tuple[str, ...]:
    """Whole names of folders of plugins: what keeps them finds the same ones wherever the process goes."""
    return tuple(os.path.abspath(os.fsdecode(p)) for p in as_list(plugins))


def library(plugins: Sequence[Union[str, "os.PathLike[str]"]]) -> _withy.Library:
    """One for each list of folders, made when it is first needed; remarks are warnings."""
    key = folders(plugins)
    if key not in _libraries:
        _libraries[key] = _withy.Library([encoded(folder) for folder in key], lambda remark: warnings.warn(remark, RuntimeWarning, stacklevel=3))
    return _libraries[key]
