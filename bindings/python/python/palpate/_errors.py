# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What palpate raises."""

from __future__ import annotations


class Error(Exception):
    """What palpate cannot do, with what it knows about it.

    Attributes:
        parameter: the name of the value that is wrong, or None.
        rule: what the value must be, in words, or None.
        value: the value, or None.
        unit: the unit of the value, ``"m"`` for instance, or None.
        path: where the value is in a scene file, or None.
        line: the line in that file, from 1, or None.
        column: the column in that line, from 1, or None.

    >>> import palpate as pp
    >>> try:
    ...     pp.ball(-1.0)
    ... except pp.ShapeError as error:
    ...     print(error.parameter, error.value)
    radius -1.0
    """

    def __init__(
        self,
        message: str = "",
        *,
        parameter: str | None = None,
        rule: str | None = None,
        value: float | None = None,
        unit: str | None = None,
        path: str | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        super().__init__(message)
        self.parameter = parameter
        self.rule = rule
        self.value = value
        self.unit = unit
        self.path = path
        self.line = line
        self.column = column

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(kind: type[Error], arguments: tuple[str, ...], fields: dict[str, object]) -> Error:
    error = kind(*arguments)
    error.__dict__.update(fields)
    return error


class ShapeError(Error, ValueError):
    """A shape cannot be made of these numbers.

    >>> import palpate as pp
    >>> try:
    ...     pp.ball(0.5).shell(0.0)
    ... except pp.ShapeError as error:
    ...     print(error)
    thickness must be positive, got 0 m
    """


class QueryError(Error, ValueError):
    """A question has no answer: neither body is bounded, a pose is not finite, or a setting is out of range.

    >>> import palpate as pp
    >>> try:
    ...     pp.separation(pp.half_space([0, 1, 0], 0), pp.half_space([0, 1, 0], 0))
    ... except pp.QueryError as error:
    ...     print("bounded" in str(error))
    True
    """


class SceneError(Error, ValueError):
    """A scene file is wrong: ``path``, ``line`` and ``column`` say where.

    >>> import palpate as pp
    >>> try:
    ...     pp.Scene.from_json('{ "version": 1, "bodies": 3 }')
    ... except pp.SceneError as error:
    ...     print(error.line)
    1
    """


class MeshError(Error, ValueError):
    """A mesh is no mesh, or bounds no solid.

    >>> import palpate as pp
    >>> try:
    ...     pp.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).shape()
    ... except pp.MeshError as error:
    ...     print(error)
    the openings are as large as the surface: it ...
    """


class GridError(Error, ValueError):
    """A grid cannot be made or read.

    >>> import palpate as pp
    >>> try:
    ...     pp.half_space([0, 1, 0], 0).baked(cell=0.1)
    ... except pp.GridError as error:
    ...     print(error)
    the shape has no bounds: a grid holds what fi...
    """


class HapticsError(Error, ValueError):
    """A servo cannot be made of these bodies and settings.

    >>> import palpate as pp
    >>> try:
    ...     pp.Servo(pp.ball(0.05), hand=[0, 0.1, 0], rate=1e-9)
    ... except pp.HapticsError as error:
    ...     print(error.parameter)
    rate
    """


class DeviceError(Error, ValueError):
    """A device, a hand path or a tour has a number that cannot be.

    >>> import palpate as pp
    >>> try:
    ...     pp.Mailbox(points=2).set([[0, 0, 0]])
    ... except pp.DeviceError as error:
    ...     print(error)
    2 contact points need as many states, got 1
    """


class DeviceLostError(Error, RuntimeError):
    """A device was lost while a servo ran: its driver set no positions for 0.1 s, or said so.

    >>> import palpate as pp
    >>> mailbox = pp.Mailbox()
    >>> try:
    ...     with pp.Servo(pp.ball(0.05), device=mailbox) as servo:
    ...         mailbox.lose()
    ...         servo.wait()
    ... except pp.DeviceLostError as error:
    ...     print(error)
    True
    the device was lost: ...
    """


class PlotError(Error, ValueError):
    """A picture cannot be drawn.

    >>> import palpate as pp
    >>> try:
    ...     pp.ball(0.5).render(width=0)
    ... except pp.PlotError as error:
    ...     print(error)
    the aspect of a picture must be positive and ...
    """


class UnknownNameError(Error, LookupError):
    """No device, figure or preset has this name; the message lists those that are there.

    >>> import palpate as pp
    >>> try:
    ...     pp.Mailbox("omeg")
    ... except pp.UnknownNameError as error:
    ...     print(error)
    there is no device "omeg"; there are touch, o...
    """


class FileError(Error, OSError):
    """A file cannot be read.

    >>> import palpate as pp
    >>> try:
    ...     pp.Scene.load(".")
    ... except pp.FileError as error:
    ...     print(isinstance(error, OSError))
    True
    """


class MissingFileError(FileError, FileNotFoundError):
    """There is no such file.

    >>> import palpate as pp
    >>> try:
    ...     pp.Scene.load("no such file.json")
    ... except FileNotFoundError as error:
    ...     print(error)
    cannot read no such file.json: ...
    """
