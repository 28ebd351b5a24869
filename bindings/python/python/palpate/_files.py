# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Files that are whole or not there."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def replace(file: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file beside the one that it then replaces."""
    place = Path(file)
    name = _beside(place, content)
    try:
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
    finally:
        os.unlink(name)
    return True


def _beside(place: Path, content: bytes) -> str:
    """Writes a file of another name into the folder of a place; gives that name."""
    handle, name = tempfile.mkstemp(prefix=f".{place.name}.", dir=place.parent)
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(content)
            out.flush()
            os.fsync(out.fileno())
        os.chmod(name, 0o666 & ~_umask())
    except BaseException:
        os.unlink(name)
        raise
    return name


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
