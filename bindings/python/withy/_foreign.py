"""Loads and bodies written in Python, for trying out.

They are slow: a load is asked at every evaluation, some microseconds each, and by one thread at a time. What is to stay
becomes a plugin in C++ (docs/extending.md).
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Sequence
from typing import Any

from . import _withy


def _kept(part: object) -> str:
    """A name of the object for scenes, which no other process gives: a scene that comes from elsewhere is refused."""
    name = f"{type(part).__name__}-{secrets.token_hex(8)}"
    _withy.keep(name, part)
    return name


def python_load(law: Callable[..., Any] | object, *, of: str | Sequence[str] | None = None,
                to: str | Sequence[str] | None = None, hinge: str | None = None, component: int | None = None,
                frame: str | None = None, sample: float | None = None, delay: float | None = None) -> dict[str, Any]:
    """A load for ``scene.loads``: a function or an object of Python. Slow, for trying out.

    At hinges ``law(t, w)``, or the method ``effort`` of an object, gives the effort [N m, N] or, with several loads ``to``,
    a sequence of them. ``t`` is the time [s], ``w`` an array of what ``of`` names or, without it, of the coordinate and the
    rate of ``hinge``. An object with ``states`` (a list of names) has differential equations: ``rates(t, w, z)`` gives their
    derivatives, ``effort(t, w, z)`` the effort, ``begin(t, w)``, if there is one, the values at the start, else zero.
    At a ``frame`` the method ``wrench(t, position, R, velocity, angular_velocity)`` gives the moment [N m] and the force [N],
    three numbers each; all of them, and R's columns, are in world axes.

    An exception stops the run: its status is ``load-failed``, its message has the text, and ``result.cause`` is the exception.
    Laws must depend on their arguments alone: integrators ask for states that they then reject. The object stays as long as
    the process, which alone knows it: a scene that is pickled goes to forked processes, and is refused by others.

    Args:
        law: the function or the object.
        of: signals that are measured, as ``of`` of controllers.
        to: loads of type ``input`` through which it acts, or "nothing": other loads measure it.
        hinge: in place of ``to`` the hinge whose rate it drives.
        component: which of its rates, from 0.
        frame: "body.frame" that a wrench acts at, in place of all the others.
        sample: period [s] at which it is asked; it holds its effort in between.
        delay: from a sample to its effort [s], a multiple of ``sample``.
    """
    given = {"of": of, "to": to, "hinge": hinge, "component": component, "frame": frame, "sample": sample, "delay": delay}
    return {"type": "python", "object": _kept(law), **{k: v for k, v in given.items() if v is not None}}


def python_body(body: object, **frames: Any) -> dict[str, Any]:
    """A body for ``scene.bodies`` from an object whose method ``shape()`` gives a dict of its mass, stiffness and modes.

    It is asked once; evaluations are as fast as those of any body. With n modes and arrays in SI units, body axes:

    ``modes``: names, a list of n; none of a rigid body. ``particles``: a list of dicts with ``mass`` [kg], ``position`` [3] and,
    of the displacement r = X + phi q + q gamma q/2, ``phi`` [3, n] and ``gamma`` [3, n, n]. ``sections``: a list of dicts with
    ``inertia`` [3, 3] [kg m^2], ``psi`` [3, n] and ``theta`` [3, n, n] of their rotation, and what particles have but mass.
    ``stations``: places by names, dicts as those of sections without inertia; "root" is the origin where it is not given.
    ``stiffness``, ``damping``: [n, n]. ``length`` [m], that deflections are measured against. What is left out is zero, but
    a mass must be there; other members are refused.

    Args:
        body: the object.
        frames: other members of a body, as ``frames={"hub": {"at": "tip"}}``.
    """
    return {"type": "python", "object": _kept(body), **frames}
