"""A bar that grows."""

from __future__ import annotations

import sys
import time
from typing import TextIO

_WIDTH = 40  # characters
_STEP = 0.1  # seconds between two pictures of it


class ProgressBar:
    """Shows on a stream, standard error by default, how many are done of how many, and for how long it has gone on."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self.stream = stream or sys.stderr
        self.began = time.monotonic()
        self.next = 0.0  # seconds

    def __call__(self, done: int, count: int) -> None:
        seconds = time.monotonic() - self.began
        if seconds < self.next and done < count:
            return
        self.next = seconds + _STEP
        filled = _WIDTH * done // count
        end = "\n" if done == count else ""
        self.stream.write(f"\r[{'#' * filled}{'.' * (_WIDTH - filled)}] {done}/{count}, {seconds:.1f} s{end}")
        self.stream.flush()
