# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Events and the end of a servo, for the threads of Python."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from palpate._felt import Event

if TYPE_CHECKING:
    from palpate._palpate import Servo

#: How long a thread that waits for events sleeps [s].
PAUSE = 0.002


def wait(servo: Servo, timeout: float | None) -> bool:
    """Waits until the servo has ended, or the time is over; whether it has ended."""
    end = None if timeout is None else time.monotonic() + timeout
    while not servo.has_ended:
        if end is not None and time.monotonic() >= end:
            return False
        time.sleep(PAUSE)
    return True


def events(servo: Servo) -> Iterator[Event]:
    """All events until the servo ends, the last ones too."""
    while True:
        has_ended = servo.has_ended
        yield from servo.take_events()
        if has_ended:
            return
        time.sleep(PAUSE)
