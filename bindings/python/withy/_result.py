"""What a run gave."""

from __future__ import annotations

import difflib
import json
import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy

from . import _withy
from ._library import encoded

if TYPE_CHECKING:
    from numpy.typing import NDArray


def nearest(name: object, known: list[str]) -> str:
    """What an error about a name says after it: the nearest one, or all."""
    near = difflib.get_close_matches(str(name), known, 1)
    if not near and not known:
        return "; there is none"
    return f"; did you mean {near[0]!r}?" if near else f"; known: {', '.join(known)}"


def unknown(what: str, name: object, known: list[str]) -> KeyError:
    """The error for a name that is not there, with the nearest one."""
    return KeyError(f"no {what} {name!r}" + nearest(name, known))


def name_in_csv(name: str) -> str:
    """What results.csv, where brackets hold units alone, calls a column: ``link1.bending_y.1`` of
    ``link1.bending_y[1]``."""
    return name.replace("[", ".").replace("]", "")


def places_of(names: list[str]) -> tuple[dict[str, int], dict[str, int]]:
    """The place of each name in a list, and those of modal coordinates as results.csv calls them."""
    return ({name: i for i, name in enumerate(names)},
            {name_in_csv(name): i for i, name in enumerate(names) if "[" in name})


class _Units(dict[str, str]):
    """SI units by the names of columns, and by those that results.csv calls them."""

    def __init__(self, names: list[str], units: list[str]) -> None:
        super().__init__(zip(names, units))

    def __missing__(self, name: str) -> str:
        names = list(self)
        place = places_of(names)[1].get(name)
        if place is None:
            raise unknown("column", name, names)
        return self[names[place]]


class Result(Mapping[str, "NDArray[numpy.float64]"]):
    """The table of a run by the names of its columns, those of results.csv: ``result["shoulder"]``.

    Attributes:
        status: ``completed``, ``inaccurate``, ``diverged``, ``singular``, ``step-underflow``, ``interrupted``,
            ``load-failed`` or ``too-stiff``.
        message: the physical reason of a bad end, or what a completed run should not keep to itself; else empty.
        units: SI unit of each column by its name, as the table has it or results.csv; empty for modal coordinates.
        table: all numbers [rows, columns], in SI units.
        summary: the content of run.json: peaks, events, steps, certificate.
        cause: where the status is ``load-failed``, the exception that a load written in Python raised; else None.
    """

    def __init__(self, status: str, message: str, names: list[str], units: list[str], table: NDArray[numpy.float64],
                 text: str, cause: BaseException | None = None) -> None:
        self.status = status
        self.message = message
        self.units: dict[str, str] = _Units(names, units)
        self.table = table
        self.cause = cause
        self.summary: dict[str, Any] = json.loads(text)
        self._index, self._of_csv = places_of(names)

    @property
    def t(self) -> NDArray[numpy.float64]:
        """Times of the rows [s]."""
        return self["t"]

    @property
    def final(self) -> dict[str, Any]:
        """The last accepted state, in the form of ``initial`` in a scene."""
        final: dict[str, Any] = self.summary["final"]
        return final

    @property
    def certificate(self) -> dict[str, Any]:
        """What was modelled, what was left out, and how large that was."""
        certificate: dict[str, Any] = self.summary["certificate"]
        return certificate

    @property
    def statistics(self) -> dict[str, Any]:
        """Of each number of outputs with ``statistics: true``: ``min`` and ``max`` with their times, ``mean``, ``rms``,
        ``integral`` and ``unit``; empty where the scene has none."""
        return self.summary.get("outputs", {})

    def __getitem__(self, name: str) -> NDArray[numpy.float64]:
        """The numbers of a column [rows], a view of the table.

        Raises:
            KeyError: with the nearest name where there is none.
        """
        index = self._at(name)
        if index is None:
            raise unknown("column", name, list(self._index))
        return self.table[:, index]

    def _at(self, name: str) -> int | None:
        return self._index.get(name, self._of_csv.get(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def __repr__(self) -> str:
        end = f"{self.t[-1]:.6g} s" if len(self.table) else "nothing"
        return f"<withy.Result {self.status}, {end}, {len(self.table)} rows of {len(self)} columns>"

    def to_pandas(self) -> Any:
        """The table as a pandas.DataFrame with the times as its index.

        Raises:
            ImportError: where there is no pandas.
        """
        import pandas

        return pandas.DataFrame(self.table, columns=list(self)).set_index("t")

    def to_hdf5(self, path: str | os.PathLike[str]) -> None:
        """Writes a dataset for each column with its unit, as ``results.h5`` of ``withy run`` has them, status and summary.

        Raises:
            RuntimeError: where the package was built without HDF5.
            OSError: where the file cannot be written.
        """
        _withy.write_hdf5(encoded(path), list(self), list(self.units.values()), self.table,
                          [("run", json.dumps(self.summary)), ("status", self.status)])

    def plot(self, *names: str, axes: Any = None) -> Any:
        """Draws columns over time with matplotlib, angles in degrees.

        Args:
            names: of columns, or their beginnings up to a dot (``"link1.tip"``), or ``"link1.tip.deflection"``; none: the
                coordinates of hinges.
            axes: of matplotlib, to draw into; new ones where left out.

        Returns:
            The axes. In a script, ``axes.figure.savefig("run.svg")`` or ``matplotlib.pyplot.show()`` comes next.

        Raises:
            ImportError: where there is no matplotlib.
            KeyError: with the nearest name where there is no such column.
        """
        import matplotlib.pyplot

        columns = self._chosen(names)
        if axes is None:
            _, axes = matplotlib.pyplot.subplots(layout="constrained")
        units = []
        for name in columns:
            angle = self.units[name] == "rad"
            units.append("deg" if angle else self.units[name] or "modal coordinate")
            axes.plot(self.t, numpy.degrees(self[name]) if angle else self[name], label=name)
        axes.set_xlabel("t [s]")
        axes.set_ylabel(" / ".join(dict.fromkeys(units)))
        axes.legend()
        return axes

    def _chosen(self, names: tuple[str, ...]) -> list[str]:
        if not names:
            hinges = self.final["hinges"]
            return [n for n in self if n in hinges or (n.split(".")[0] in hinges and self.units[n] in ("m", "rad"))]
        chosen = []
        for name in names:
            after = "_" if name.endswith(".deflection") else "."
            index = self._at(name)
            found = [n for n in self if n.startswith(name + after)] if index is None else [list(self)[index]]
            if not found:
                raise unknown("column", name, list(self))
            chosen += found
        return chosen
