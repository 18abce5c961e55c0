"""Solves on this machine by the command line, without a service."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any

from . import cbor, questions
from .document import encoded
from .errors import ServiceUnreachable
from .exchange import refused
from .questions import AnyProblem, Progress
from .result import Result

_BAD_INPUT = 2  # exit code


class Local:
    """The program `signorinid`, found on the path or given; `solve` and `map` do what those of `Client` do.

    `workers` solves run at the same time in `map`, by default as many as there are cores.
    """

    def __init__(self, program: str | os.PathLike[str] = "signorinid", *, workers: int | None = None) -> None:
        self._program = program
        self._workers = workers or os.cpu_count() or 1

    def solve(self, problem: AnyProblem, *, fields: Sequence[str] | None = None) -> Result:
        """Solves a problem. Raises SolveFailed, Refused, and ServiceUnreachable if there is no such program."""
        return self._result(encoded(problem), questions.fields_of(problem, fields), None).check()

    def map(
        self, problems: Iterable[AnyProblem], *, fields: Sequence[str] | None = None, progress: Progress = False
    ) -> list[Result]:
        """Solves many problems and returns their results in the same order; see `Client.map`."""
        commands = [(encoded(problem), questions.fields_of(problem, fields), i) for i, problem in enumerate(problems)]
        tell = questions.teller(progress, len(commands))
        with ThreadPoolExecutor(self._workers) as pool:
            try:
                solves = [pool.submit(self._result, *command) for command in commands]
                for done, solve in enumerate(as_completed(solves), 1):
                    solve.result()
                    tell(done)
                return [solve.result() for solve in solves]
            finally:
                pool.shutdown(wait=False, cancel_futures=True)

    def _result(self, problem: bytes, fields: Sequence[str], index: int | None) -> Result:
        command = [self._program, "solve", "--format", "cbor", "--fields", ",".join(fields), "-"]
        try:
            ended = subprocess.run(command, input=problem, capture_output=True, check=False)
        except OSError as error:
            raise ServiceUnreachable(f"{os.fspath(self._program)} cannot be run: {error}") from error
        if ended.stdout:
            document = cbor.loads(ended.stdout)
            return Result(document if ended.returncode == 0 else document | {"error": _details(ended.stderr)})
        details = _details(ended.stderr)
        if ended.returncode == _BAD_INPUT:
            raise refused(details, details.get("status"), index)
        return Result({"status": "failed", "error": details})


def _details(errors: bytes) -> dict[str, Any]:
    """What the program says of an error, the last line that is a document; else all that it says."""
    for line in reversed(errors.splitlines()):
        try:
            details = json.loads(line)
        except ValueError:
            continue
        if isinstance(details, dict):
            return details
    return {"title": "The program failed", "detail": errors.decode(errors="replace").strip()}
