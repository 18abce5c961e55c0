"""Solves on this machine by the command line, without a service."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any

from . import cbor, questions
from .errors import BadReply, ServiceUnreachable
from .exchange import refused
from .questions import AnyProblem, Progress
from .result import Result

_BAD_INPUT = 2  # exit code
_SHOWN = 120  # bytes of what is not understood


class Local:
    """The program `signorinid`, found on the path or given; `solve` and `map` do what those of `Client` do.

    `workers` solves run at the same time in `map`, by default as many as there are cores. What runs is ended with the
    call, also by Ctrl-C.
    """

    def __init__(self, program: str | os.PathLike[str] = "signorinid", *, workers: int | None = None) -> None:
        if workers is not None and workers < 1:
            raise ValueError(f"workers is how many solves run at the same time, 1 or more, and not {workers}")
        self._program = os.fspath(program)
        self._workers = workers or os.cpu_count() or 1

    def solve(self, problem: AnyProblem, *, fields: Sequence[str] | None = None) -> Result:
        """Solves a problem.

        Raises SolveFailed, Refused, ServiceUnreachable if there is no such program, and BadReply if it is another one.
        """
        with _Runs(self._program) as runs:
            return runs.result(*questions.posed(problem, fields), None).check()

    def map(
        self, problems: Iterable[AnyProblem], *, fields: Sequence[str] | None = None, progress: Progress = False
    ) -> list[Result]:
        """Solves many problems and returns their results in the same order; see `Client.map`."""
        posed = questions.all_posed(problems, fields)
        tell = questions.teller(progress, len(posed))
        # The runs are ended before the threads that wait for them.
        with ThreadPoolExecutor(self._workers) as pool, _Runs(self._program) as runs:
            try:
                solves = [pool.submit(runs.result, *each, index) for index, each in enumerate(posed)]
                for done, solve in enumerate(as_completed(solves), 1):
                    solve.result()
                    tell(done)
                return [solve.result() for solve in solves]
            finally:
                pool.shutdown(wait=False, cancel_futures=True)


class _Runs:
    """The processes of one call, which do not outlive it."""

    def __init__(self, program: str) -> None:
        self.program = program
        self.lock = threading.Lock()
        self.running: set[subprocess.Popen[bytes]] | None = set()

    def __enter__(self) -> _Runs:
        return self

    def __exit__(self, *_: object) -> None:
        with self.lock:
            running, self.running = self.running or set(), None
        for process in running:
            process.kill()

    def result(self, problem: bytes, fields: Sequence[str], index: int | None) -> Result:
        """What the program finds out. Raises Refused, ServiceUnreachable, BadReply."""
        code, said, errors = self._run(
            [self.program, "solve", "--format", "cbor", "--fields", ",".join(fields), "-"], problem
        )
        details = _details(errors)
        if code < 0:
            details = {"title": "The program was ended", "detail": f"{self.program} was ended by {_signal(-code)}"}
        if said and code >= 0:
            document = self._document(said)
            return Result(document if code == 0 else document | {"error": details})
        if code == _BAD_INPUT:
            raise refused(details, details.get("status"), index)
        if code == 0:
            raise self._bad("nothing", errors)
        return Result({"status": "failed", "error": details})

    def _run(self, command: list[str], problem: bytes) -> tuple[int, bytes, bytes]:
        try:
            with self.lock:
                if self.running is None:
                    raise InterruptedError("the call has ended")
                process = subprocess.Popen(
                    command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
                )
                self.running.add(process)
        except (OSError, ValueError) as error:
            raise ServiceUnreachable(f"{self.program} cannot be run: {error}") from error
        with process:
            try:
                said, errors = process.communicate(problem)
            except BaseException:
                process.kill()
                process.wait()  # After Ctrl-C, leaving the block does not.
                raise
        with self.lock:
            if self.running is not None:
                self.running.discard(process)
        return process.returncode, said, errors

    def _document(self, said: bytes) -> dict[str, Any]:
        try:
            document = cbor.loads(said)
        except cbor.CborError as error:
            raise self._bad(f"{said[:_SHOWN]!r}", str(error).encode()) from error
        if not isinstance(document, dict) or not isinstance(document.get("status"), str):
            raise self._bad(f"{said[:_SHOWN]!r}", b"it is no result")
        return document

    def _bad(self, said: str, why: bytes) -> BadReply:
        reason = why[:_SHOWN].decode(errors="replace").strip()
        return BadReply(f"{self.program} is no signorinid, or none for this client: it writes {said}; {reason}")


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _details(errors: bytes) -> dict[str, Any]:
    """What the program says of an error, the last line that is a document; else all that it says."""
    for line in reversed(errors.splitlines()):
        try:
            details = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if isinstance(details, dict):
            return details
    return {"title": "The program failed", "detail": errors.decode(errors="replace").strip()}
