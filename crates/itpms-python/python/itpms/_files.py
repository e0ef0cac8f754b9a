"""Files that are complete under their names or not there."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path

from ._errors import OutputError


def write(path: str | PathLike[str], content: bytes) -> None:
    """Writes a file beside its place, then gives it its name."""
    target = Path(path)
    beside = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        beside.write_bytes(content)
        beside.replace(target)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise OutputError(f"{target}: cannot be written: {error.strerror}") from None
