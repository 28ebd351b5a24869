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
    """A shape cannot be made of these numbers."""


class QueryError(Error, ValueError):
    """A question has no answer: neither body is bounded, a pose is not finite, or a setting is out of range."""


class SceneError(Error, ValueError):
    """A scene file is wrong: ``path``, ``line`` and ``column`` say where."""


class MeshError(Error, ValueError):
    """A mesh is no mesh, or bounds no solid."""


class GridError(Error, ValueError):
    """A grid cannot be made or read."""


class HapticsError(Error, ValueError):
    """A servo cannot be made of these bodies and settings."""


class DeviceError(Error, ValueError):
    """A device, a hand path or a tour has a number that cannot be."""


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
    """A picture cannot be drawn."""


class UnknownNameError(Error, LookupError):
    """No device, figure or preset has this name; the message lists those that are there."""


class FileError(Error, OSError):
    """A file cannot be read."""


class MissingFileError(FileError, FileNotFoundError):
    """There is no such file.

    >>> import palpate as pp
    >>> try:
    ...     pp.Scene.load("no such file.json")
    ... except FileNotFoundError as error:
    ...     print(error)
    cannot read no such file.json: ...
    """
