"""The plugins of the process."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Union

from . import _withy

_libraries: dict[tuple[str, ...], _withy.Library] = {}


def library(plugins: Sequence[Union[str, "os.PathLike[str]"]]) -> _withy.Library:
    """One for each list of folders, made when it is first needed; remarks are warnings."""
    key = tuple(os.path.abspath(os.fspath(p)) for p in plugins)
    if key not in _libraries:
        _libraries[key] = _withy.Library(list(key), lambda remark: warnings.warn(remark, RuntimeWarning, stacklevel=3))
    return _libraries[key]
