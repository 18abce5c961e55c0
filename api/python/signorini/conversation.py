"""What is said to a service and when: for the Client and its asyncio twin alike.

A solve is one request with an idempotency key, which is repeated until it is answered with the result: after the wait
that a service grants, after a refusal for now, after a lost connection, and after a restart of the service. The key
makes all of these the same solve.
"""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any
from urllib.parse import urlencode

from .errors import Refused, ServiceUnreachable, SignoriniError
from .exchange import CBOR_SEQUENCE, Conversation, Lost, Pause, Reply, Request
from .result import Result

#: Seconds for which one request waits; less than what gateways commonly let pass.
LONGEST_WAIT = 50.0
#: Problems that are given to a service before their results are fetched, as long as it has not said what it takes.
FIRST_WINDOW = 128
#: No refusal makes the window smaller; workers have enough to do by it.
SMALLEST_WINDOW = 8
#: Seconds between attempts to reach a service.
FIRST_PAUSE, LONGEST_PAUSE = 0.1, 5.0


class Line:
    """Reaches a service, again and again for `patience` seconds of pauses if it has once been reached."""

    def __init__(self, patience: float) -> None:
        self.patience = patience
        self.was_reached = False

    def ask(self, request: Request) -> Conversation[Reply]:
        """The reply, also a refusal. Raises ServiceUnreachable."""
        for pause in self._pauses():
            event = yield request
            if isinstance(event, Reply):
                self.was_reached = True
                if not event.is_from_no_service:
                    return event
                reason = f"a gateway answers {event.status}"
            else:
                assert isinstance(event, Lost)
                self.was_reached |= event.sent
                reason = event.reason
            if not self.was_reached:
                break
            yield Pause(pause)
        raise ServiceUnreachable(f"the service cannot be reached: {reason}")

    def ask_until_taken(self, request: Request) -> Conversation[Reply]:
        """The reply, after as many refusals for now as there are."""
        while (reply := (yield from self.ask(request))).is_refusal_for_now:
            yield Pause(reply.retry_after or 0.0)
        return reply

    def _pauses(self) -> Iterator[float]:
        pause, paused = FIRST_PAUSE, 0.0
        while paused <= self.patience:
            yield pause
            paused += pause
            pause = min(2 * pause, LONGEST_PAUSE)


class Ticket:
    """One problem on its way: the request that solves it, and the name of the solve once that is known."""

    def __init__(self, body: bytes, fields: Sequence[str]) -> None:
        self.body = body
        self.key = str(uuid.uuid4())
        self.fields = fields
        self.id: str | None = None

    def request(self, wait: float) -> Request:
        query = urlencode({"wait": f"{wait:.3f}", "fields": ",".join(self.fields)}, safe=",")
        return Request("POST", f"/v1/solves?{query}", self.body, {"Idempotency-Key": self.key}, wait)

    def result(self, reply: Reply) -> Result | None:
        """The result if the solve has ended. Raises Refused."""
        document = reply.document()
        self.id = document["id"]
        return Result(document) if reply.status == 200 else None


def solve(line: Line, ticket: Ticket) -> Conversation[Result]:
    """Solves one problem; it is cancelled if the conversation is interrupted."""
    try:
        while True:
            reply = yield from line.ask_until_taken(ticket.request(LONGEST_WAIT))
            if result := ticket.result(reply):
                return result
    except GeneratorExit:
        raise
    except BaseException as error:
        yield from _cancel([ticket], error)
        raise


class BatchTicket:
    """Problems that are posted together: the request that does so, and the name of the batch once that is known."""

    #: Seconds without a word in which the service is believed to solve on.
    LONGEST_SILENCE = 3600.0

    def __init__(self, body: bytes, fields: Sequence[str]) -> None:
        self.body = body
        self.key = str(uuid.uuid4())
        self.fields = fields
        self.id: str | None = None
        self.solves: list[str] = []

    def request(self) -> Request:
        return Request("POST", "/v1/batches", self.body, {"Idempotency-Key": self.key})

    def read(self, reply: Reply) -> None:
        """Learns the names. Raises Refused."""
        document = reply.document()
        self.id, self.solves = document["id"], document["solves"]

    def results(self) -> Request:
        """Asks for all results, which come as the solves end."""
        path = f"/v1/batches/{self.id}/results?" + urlencode({"fields": ",".join(self.fields)}, safe=",")
        return Request("GET", path, headers={"Accept": CBOR_SEQUENCE}, wait=self.LONGEST_SILENCE)


def solve_batch(line: Line, ticket: BatchTicket) -> Conversation[list[Result]]:
    """Solves the problems of a batch, in order; all are cancelled if the conversation is interrupted."""
    try:
        ticket.read((yield from line.ask_until_taken(ticket.request())))
        reply = yield from line.ask_until_taken(ticket.results())
        results = {document["id"]: Result(document) for document in reply.documents()}
        if gone := [id for id in ticket.solves if id not in results]:
            raise SignoriniError(f"{len(gone)} solves of the batch were deleted before they were fetched")
        return [results[id] for id in ticket.solves]
    except GeneratorExit:
        raise
    except BaseException as error:
        yield from _cancel_batch(ticket, error)
        raise


def _cancel_batch(ticket: BatchTicket, error: BaseException) -> Conversation[None]:
    """Cancels what the service may have of it, without patience; the error says why."""
    if isinstance(error, (ServiceUnreachable, Refused)):
        return
    if ticket.id is None:
        event = yield ticket.request()
        if isinstance(event, Reply) and event.status < 400:
            ticket.read(event)
    if ticket.id is not None:
        yield Request("DELETE", f"/v1/batches/{ticket.id}")


def solve_all(
    line: Line,
    tickets: Sequence[Ticket],
    tell: Callable[[int], None],
    clock: Callable[[], float] = time.monotonic,
) -> Conversation[list[Result]]:
    """Solves all problems, in order, and tells how many are done; all are cancelled if it is interrupted."""
    batch = _Batch(line, tickets, clock)
    try:
        while batch.results_missing():
            if batch.may_send():
                yield from batch.send()
            else:
                yield from batch.fetch()
                tell(len(batch.results))
        return batch.results
    except GeneratorExit:
        raise
    except BaseException as error:
        yield from _cancel(batch.on_their_way, error)
        raise


class _Batch:
    """Problems that wait, those that the service has, and results, each in the order of the problems.

    The service has as many as fill its queue: after a refusal, which says how long that is, a quarter less.
    """

    def __init__(self, line: Line, tickets: Sequence[Ticket], clock: Callable[[], float]) -> None:
        self.line = line
        self.clock = clock
        self.waiting = deque(tickets)
        self.on_their_way: deque[Ticket] = deque()
        self.results: list[Result] = []
        self.count = len(tickets)
        self.window = FIRST_WINDOW
        self.closed_until = clock()

    def results_missing(self) -> bool:
        return len(self.results) < self.count

    def may_send(self) -> bool:
        has_room = len(self.on_their_way) < self.window
        return bool(self.waiting) and has_room and self.clock() >= self.closed_until

    def send(self) -> Conversation[None]:
        """Gives the service one more problem, or learns when it takes more."""
        ticket = self.waiting.popleft()
        self.on_their_way.append(ticket)
        reply = yield from self.line.ask(ticket.request(wait=0.0))
        if not reply.is_refusal_for_now:
            self._read(ticket, reply)
            return
        self.waiting.appendleft(self.on_their_way.pop())
        self.closed_until = self.clock() + (reply.retry_after or 0.0)
        while self.on_their_way and (yield from self._fetch_within(0.0)):
            pass
        self.window = max(min(self.window, len(self.on_their_way)) * 3 // 4, SMALLEST_WINDOW)

    def fetch(self) -> Conversation[None]:
        """Waits for the first result that is missing, but no longer than until more may be sent."""
        has_more_to_send = self.waiting and len(self.on_their_way) < self.window
        wait = max(self.closed_until - self.clock(), 0.0) if has_more_to_send else LONGEST_WAIT
        if self.on_their_way:
            yield from self._fetch_within(min(wait, LONGEST_WAIT))
        else:
            yield Pause(wait)

    def _fetch_within(self, wait: float) -> Conversation[bool]:
        """Whether the first result that is missing came."""
        ticket = self.on_their_way[0]
        reply = yield from self.line.ask_until_taken(ticket.request(wait))
        result = self._read(ticket, reply)
        if result is None:
            return False
        self.on_their_way.popleft()
        self.results.append(result)
        return True

    def _read(self, ticket: Ticket, reply: Reply) -> Result | None:
        if reply.status >= 400:
            raise reply.refusal(index=len(self.results) + self.on_their_way.index(ticket))
        return ticket.result(reply)


def _cancel(tickets: Iterable[Ticket], error: BaseException) -> Conversation[None]:
    """Cancels what the service may have of these, without patience; the error says why."""
    if isinstance(error, ServiceUnreachable):
        return
    for ticket in tickets:
        if ticket.id is None and not isinstance(error, Refused):
            yield from _learn_id(ticket)
        if ticket.id is not None and isinstance((yield Request("DELETE", f"/v1/solves/{ticket.id}")), Lost):
            return


def _learn_id(ticket: Ticket) -> Conversation[None]:
    """Whether a request has arrived whose reply was not read, only its repetition tells."""
    event = yield ticket.request(wait=0.0)
    if isinstance(event, Reply):
        try:
            ticket.result(event)
        except SignoriniError:
            pass


def list_solves(line: Line, request: Request) -> Conversation[list[dict[str, Any]]]:
    """The status documents of all pages, newest first. Raises Refused."""
    solves: list[dict[str, Any]] = []
    while True:
        page = yield from ask(line, request)
        solves += page["solves"]
        if page["links"]["next"] is None:
            return solves
        request = Request("GET", page["links"]["next"])


def ask(line: Line, request: Request) -> Conversation[Any]:
    """The document of a reply. Raises Refused."""
    return (yield from line.ask_until_taken(request)).document()
