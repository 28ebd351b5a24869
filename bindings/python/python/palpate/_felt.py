# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What was felt: frozen objects with names, with a row for each tick where there are many. Lengths are in metres."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate._answer import Answer, Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Touch(Answer):
    """A contact point at an instant, in :attr:`Snapshot.touches`.

    Fields:
        device: Where the hand is [m], shape (D,).
        velocity: How fast it moves [m/s], shape (D,).
        proxy: Where the proxy is, which enters no body [m], shape (D,).
        wanted: The force that the material wants [N], shape (D,).
        force: The force that was written, after the safety chain [N], shape (D,).
        normal: The outward unit normal of the surface that is touched, shape (D,); zero if none is.
        body: The name of the body that is touched; None if none is.
        is_slipping: Whether the proxy slips.

    >>> import palpate as pp
    >>> felt = pp.Servo(pp.ball(0.05), hand=[0, 0.049, 0])
    >>> with felt as servo:
    ...     while servo.latest() is None:
    ...         pass
    ...     [touch] = servo.latest().touches
    >>> touch.device.shape, touch.body
    ((3,), 'body')
    """

    device: Floats
    velocity: Floats
    proxy: Floats
    wanted: Floats
    force: Floats
    normal: Floats
    body: str | None
    is_slipping: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class HeldTool(Answer):
    """A tool with a shape, in :attr:`Snapshot.tool`; in :attr:`Trace.tool` each field has an axis for the n rows first.

    Turns and torques have the shape (3,); in the plane they are about z, and numbers.

    Fields:
        pose: Where the tool is, which enters no body: a matrix of shape (D + 1, D + 1).
        turn: How the device is turned relative to the tool, as a rotation vector [rad].
        torque: The torque that the contacts want about the origin of the tool [N m], in the world.
        given_torque: The torque that was written [N m], in the world; NaN of a device without rotation.
        contacts: How many contacts push.
        resolution: How far the surface of the tool may be from the balls that stand for it [m].
        is_degraded: Whether the time of a tick did not suffice for all balls.
        is_covered: Whether bodies cover the tool, which then gives no force.

    >>> import palpate as pp
    >>> scene = pp.Scene(pp.ball(0.05), tool={"shape": pp.capsule(0.004, 0.03)})
    >>> tool = pp.feel(scene, hand=[0, 0.06, 0], duration=0.02).trace.tool
    >>> tool.pose.shape, tool.contacts.shape
    ((20, 4, 4), (20,))
    """

    pose: Floats
    turn: Floats | float
    torque: Floats | float
    given_torque: Floats | float
    contacts: NDArray[np.uint32] | int
    resolution: Floats | float
    is_degraded: NDArray[np.bool_] | bool
    is_covered: NDArray[np.bool_] | bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Snapshot(Answer):
    """The newest state of a servo, by :meth:`Servo.latest`.

    Fields:
        time: The time of the servo [s].
        ticks: How many ticks there were.
        force: The largest force since the last snapshot [N].
        depth: The largest depth since the last snapshot [m].
        touches: The contact points.
        tool: The tool; None if contact points touch.
        is_stopped: Whether the emergency stop holds.
        is_lifted: Whether the hand is lifted off the bodies, and passes through them.
        events_lost: Events that nobody took in time.

    >>> import palpate as pp
    >>> with pp.Servo(pp.ball(0.05), hand=[0, 0.049, 0]) as servo:
    ...     while servo.latest() is None:
    ...         pass
    ...     now = servo.latest()
    >>> now.ticks > 0, len(now.touches), now.is_stopped
    (True, 1, False)
    """

    time: float
    ticks: int
    force: float
    depth: float
    touches: tuple[Touch, ...]
    tool: HeldTool | None
    is_stopped: bool
    is_lifted: bool
    events_lost: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Event(Answer):
    """What a contact point began or ended, by :meth:`Servo.events`.

    Fields:
        tick: The tick, from 0.
        point: The contact point.
        body: The name of the body; None of a button.
        button: The number of the button, from 0; None of what is no button.
        kind: "touch", "leave", "slip", "stick", "pop", "carried", "placed", "squeezed", "button_down"
            or "button_up". An edit carries what it covers, or places it anew. A body that moves
            squeezes a hand that it leaves no room.
        speed: Of a touch, the speed along the normal, relative to the body [m/s].
        force: Of a pop, the force that broke the layer [N].
        distance: Of what is carried, how far [m].

    >>> import palpate as pp
    >>> with pp.Servo(pp.Scene({"ball": pp.ball(0.05)}), hand=[0, 0.049, 0], duration=0.05) as servo:
    ...     first = next(event for event in servo.events() if event.kind == "touch")
    >>> first.kind, first.body, first.point
    ('touch', 'ball', 0)
    """

    tick: int
    point: int
    body: str | None
    button: int | None
    kind: str
    speed: float | None
    force: float | None
    distance: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace(Answer):
    """Ticks that were recorded: n rows, one for each tick and contact point.

    Fields:
        time: The time of the tick [s], shape (n,).
        point: The contact point, shape (n,).
        device: Where the hand is [m], shape (n, D).
        proxy: Where the proxy is [m], shape (n, D).
        wanted: The force that the material wants [N], shape (n, D).
        force: The force that was written [N], shape (n, D).
        normal: The outward unit normal, shape (n, D).
        contact: Whether a body is touched, shape (n,).
        body: The place of the body in ``scene.names``, shape (n,); without meaning where none is touched.
        is_slipping: Whether the proxy slips, shape (n,).
        is_lifted: Whether the hand is lifted off the bodies, and passes through them, shape (n,).
        taken: What the forces took from the hand so far [J], shape (n,).
        given: What they gave to it so far [J], shape (n,).
        kept: What the forces that the material wanted would have given, and the safety chain held back [J], shape (n,).
        tool: The tool; None if contact points touch.
        evaluations: How often the field was evaluated, shape (n,).
        cost_ns: How long the tick took [ns], shape (n,).
        lateness_ns: How late it was [ns], shape (n,).
        lost: Rows that were not kept.

    >>> import palpate as pp
    >>> trace = pp.feel(pp.ball(0.05), hand=[0, 0.049, 0], duration=0.05).trace
    >>> len(trace), trace.force.shape, trace.lost
    (50, (50, 3), 0)
    """

    time: Floats
    point: NDArray[np.uint32]
    device: Floats
    proxy: Floats
    wanted: Floats
    force: Floats
    normal: Floats
    contact: NDArray[np.bool_]
    body: NDArray[np.uint32]
    is_slipping: NDArray[np.bool_]
    is_lifted: NDArray[np.bool_]
    taken: Floats
    given: Floats
    kept: Floats
    tool: HeldTool | None
    evaluations: NDArray[np.uint32]
    cost_ns: NDArray[np.uint64]
    lateness_ns: NDArray[np.uint64]
    lost: int

    def __len__(self) -> int:
        return len(self.time)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The rows as columns of numbers, for ``pandas.DataFrame``, ``pyarrow.table`` or ``polars.DataFrame``.

        >>> import palpate as pp, pandas
        >>> felt = pp.feel(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.01)
        >>> pandas.DataFrame(felt.trace.columns()).shape
        (10, 27)
        """
        columns: dict[str, NDArray[Any]] = {}
        for name, value in (*_arrays(self), *_arrays(self.tool)):
            if value.ndim == 1:
                columns[name] = value
            elif value.ndim == 2:
                for axis, letter in zip(range(value.shape[1]), "xyz", strict=False):
                    columns[f"{name}_{letter}"] = np.ascontiguousarray(value[:, axis])
            else:
                for i, k in np.ndindex(value.shape[1] - 1, value.shape[2]):
                    columns[f"{name}_{i}{k}"] = np.ascontiguousarray(value[:, i, k])
        return columns


def _arrays(answer: Trace | HeldTool | None) -> Iterator[tuple[str, NDArray[Any]]]:
    for field in fields(answer) if answer is not None else ():
        value = getattr(answer, field.name)
        if isinstance(value, np.ndarray):
            yield field.name, value


@dataclass(frozen=True, eq=False, kw_only=True)
class Felt(Answer):
    """What :func:`feel` felt.

    Fields:
        report: What the run was like: ticks, forces, safety, as a dict.
        trace: All ticks.

    >>> import palpate as pp
    >>> felt = pp.feel(pp.ball(0.05), hand=[0, 0.049, 0], duration=0.05)
    >>> felt.report["ticks"], felt.report["ending"]["kind"], len(felt.trace)
    (50, 'finished', 50)
    """

    report: dict[str, Any]
    trace: Trace
