"""A service without sockets and without time: it answers requests of a conversation, and its clock is a number."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qs, urlsplit

from signorini.exchange import Conversation, Event, Lost, Pause, Reply, Request


@dataclass
class Job:
    id: str
    body: bytes
    ends_at: float
    was_cancelled: bool = False


class PretendedService:
    """Workers, `seconds` a solve, and a queue of `limit`; a problem that is `bad` is refused.

    Of all requests but the first the share `lost` has no reply, half of these after they have arrived. Of what has
    ended the last `kept` are kept. A problem with `"slow"` takes a thousand times as long.
    """

    def __init__(
        self,
        *,
        limit: int = 64,
        seconds: float = 0.01,
        lost: float = 0.0,
        seed: int = 0,
        kept: int = 10000,
        workers: int = 1,
    ) -> None:
        self.limit = limit
        self.seconds = seconds
        self.lost = lost
        self.luck = random.Random(seed)
        self.kept = kept
        self.free_at = [0.0] * workers
        self.now = 0.0
        self.jobs: dict[str, Job] = {}  # by key
        self.bodies: list[bytes] = []  # of all that were accepted
        self.refused_at: list[float] = []
        self.accepted_at: list[float] = []
        self.requests: list[Request] = []
        self.is_up = True
        self.retry_after = 5
        self.waits = True
        self.prepared: list[Reply] = []  # replies that are given before its own

    def clock(self) -> float:
        return self.now

    def unfinished(self) -> list[Job]:
        return [job for job in self.jobs.values() if job.ends_at > self.now and not job.was_cancelled]

    def do(self, step: Request | Pause) -> Event:
        if isinstance(step, Pause):
            self.now += step.seconds
            return None
        self.requests.append(step)
        self.now += 0.001
        if not self.is_up:
            return Lost("nobody listens", reached=False)
        if len(self.requests) > 1 and self.luck.random() < self.lost:
            if self.luck.random() < 0.5:
                self.answer(step)
            return Lost("the line was cut", reached=False)
        return self.answer(step)

    def answer(self, request: Request) -> Reply:
        if self.prepared:
            return self.prepared.pop(0)
        self.drop()
        if request.method == "DELETE":
            for job in self.jobs.values():
                if request.path.endswith("/" + job.id):
                    job.was_cancelled = True
                    return reply(202, {"id": job.id, "status": "cancelled"})
            return reply(404, {"type": "urn:signorini:problem:unknown-solve", "title": "Unknown solve"})
        if request.method == "GET":
            return reply(200, {"solves": [{"id": job.id, "status": self.status(job)} for job in self.jobs.values()]})
        key = request.headers["Idempotency-Key"]
        if key not in self.jobs:
            if b"bad" in request.body:
                return reply(422, {"title": "A bad problem", "detail": "It is bad.", "type": "urn:bad"})
            if len(self.unfinished()) > self.limit:
                self.refused_at.append(self.now)
                return reply(503, {"title": "full"}, {"retry-after": str(self.retry_after)})
            self.accepted_at.append(self.now)
            self.accept(key, request.body)
        job = self.jobs[key]
        wait = float(parse_qs(urlsplit(request.path).query)["wait"][0]) if self.waits else 0.0
        if job.ends_at > self.now + wait:
            self.now += wait
            return reply(202, {"id": job.id, "status": "queued"})
        self.now = max(self.now, job.ends_at)
        self.drop()
        if key not in self.jobs:
            return reply(410, {"type": "urn:signorini:problem:deleted", "title": "The solve was deleted"})
        return reply(200, {"id": job.id, "status": "succeeded", "problem": json.loads(job.body)})

    def accept(self, key: str, body: bytes) -> None:
        worker = min(range(len(self.free_at)), key=self.free_at.__getitem__)
        seconds = self.seconds * (1000 if b"slow" in body else 1)
        self.free_at[worker] = max(self.now, self.free_at[worker]) + seconds
        self.jobs[key] = Job(f"JOB{len(self.bodies)}", body, self.free_at[worker])
        self.bodies.append(body)

    def status(self, job: Job) -> str:
        return "succeeded" if job.ends_at <= self.now else "queued"

    def drop(self) -> None:
        """Drops the oldest of what has ended, as a service with a small --keep-bytes does."""
        ended = sorted((job.ends_at, key) for key, job in self.jobs.items() if job.ends_at <= self.now)
        for _, key in ended[: -self.kept]:
            del self.jobs[key]


def reply(status: int, document: dict[str, Any], headers: dict[str, str] | None = None) -> Reply:
    return Reply(status, {"content-type": "application/json", **(headers or {})}, json.dumps(document).encode())


def drive(
    talk: Conversation[Any], service: PretendedService, before: Callable[[Request | Pause], None] = lambda step: None
) -> Any:
    """What the conversation with the service comes to; `before` sees every step, and may raise."""
    try:
        step = next(talk)
        while True:
            try:
                before(step)
                event = service.do(step)
            except BaseException as interruption:
                step = talk.throw(interruption)
            else:
                step = talk.send(event)
    except StopIteration as end:
        return end.value
