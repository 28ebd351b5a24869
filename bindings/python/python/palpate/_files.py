# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Files that are whole or not there, and not larger than is read."""

from __future__ import annotations

import os
import secrets
import shutil
from pathlib import Path
from typing import IO


#: The largest file that is read whole [bytes].
LARGEST = 1 << 28


def read(file: Path) -> str:
    """The text of a file that is not too large."""
    with open(file, "rb") as opened:
        content = opened.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise ValueError(f"{file} is longer than {LARGEST} bytes, the most that are read")
    return content.decode("utf-8")


def replace(file: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file beside the one that it then replaces, of which it keeps the mode; a link stays one."""
    place = Path(os.path.realpath(file))
    name = _beside(place, content)
    try:
        if place.exists():
            shutil.copymode(place, name)
        os.replace(name, place)
    except BaseException:
        os.unlink(name)
        raise


def claim(file: Path, content: bytes) -> bool:
    """Writes a file whole if there is none; says whether it did. Of several that try, one does."""
    name = _beside(file, content)
    try:
        os.link(name, file)
    except FileExistsError:
        return False
    except OSError:
        # Some file systems have no links. A file that is cut off there is reported as damaged.
        return _created(file, content)
    finally:
        os.unlink(name)
    return True


def _created(file: str | os.PathLike[str], content: bytes) -> bool:
    try:
        with open(file, "xb") as out:
            _written(out, content)
    except FileExistsError:
        return False
    return True


def _written(out: IO[bytes], content: bytes) -> None:
    out.write(content)
    out.flush()
    os.fsync(out.fileno())


def _beside(place: Path, content: bytes) -> str:
    """Writes a file of another name into the folder of a place; gives that name."""
    name = place.with_name(f".{place.name}.{secrets.token_hex(8)}")
    try:
        with open(name, "xb") as out:
            _written(out, content)
    except OSError as error:
        name.unlink(missing_ok=True)
        # Of the file that was asked for, not of the one beside it.
        raise OSError(error.errno, error.strerror, str(place)) from error
    except BaseException:
        name.unlink(missing_ok=True)
        raise
    return str(name)
