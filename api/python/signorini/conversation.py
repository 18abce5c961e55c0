"""What is said to a service and when: for the Client and its asyncio twin alike.

A solve is one request with an idempotency key, which is repeated until it is answered with the result: after the wait
that a service grants, after a refusal for now, after a lost connection, and after a restart of the service. The key
makes all of these the same solve.
"""

from __future__ import annotations

import contextlib
import re
import time
import uuid
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any
from urllib.parse import quote, urlencode

from .errors import Refused, ResultsDropped, ServiceUnreachable, SignoriniError
from .exchange import CBOR_SEQUENCE, Conversation, Hopeless, Lost, Pause, Reply, Request
from .result import Result

#: Seconds for which one request waits; less than what gateways commonly let pass.
LONGEST_WAIT = 50.0
#: Problems that a service has at most before their results are fetched. This window grows with each result, as long
#: as no problem is refused and no result dropped.
LARGEST_WINDOW = 128
#: It begins with this one, and no refusal makes it smaller; workers have enough to do by it.
SMALLEST_WINDOW = 8
#: Seconds between attempts to reach a service.
FIRST_PAUSE, LONGEST_PAUSE = 0.1, 5.0
#: Seconds until the next request if the service waits no longer, though it was asked to.
PAUSE_WITHOUT_WAIT = 1.0
#: Seconds after which it is looked what has ended out of turn; twice as many after nothing was found.
FIRST_LOOK = 1.0
#: How often the result of a problem may be dropped before it is fetched.
MOST_LOSSES = 2
#: Seconds in which a service has to answer that is asked to cancel something.
PATIENCE_TO_CANCEL = 5.0
ENDED = ("succeeded", "failed", "cancelled")
#: Ends of the types of refusals: the solve was there when it was asked for, and gone when it was to be answered.
DROPPED = (":deleted", ":unknown-solve")


def checked_patience(seconds: float) -> float:
    """The seconds. Raises ValueError for what is no number, or less than 0."""
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)) or not seconds >= 0:
        raise ValueError(f"patience is a number of seconds, 0 or more, and not {seconds!r}")
    return seconds


class Line:
    """Reaches a service, again and again for `patience` seconds of pauses if it has once been reached."""

    def __init__(self, patience: float, clock: Callable[[], float] = time.monotonic) -> None:
        self.patience = patience
        self.clock = clock
        self.was_reached = False

    def ask(self, request: Request) -> Conversation[Reply]:
        """The reply, also a refusal. Raises ServiceUnreachable, and BadReply if no service answers there."""
        pauses = self._pauses()
        while True:
            event = yield request
            if isinstance(event, Hopeless):
                raise event.error
            if isinstance(event, Reply):
                self.was_reached = True
                if not event.is_from_no_service:
                    return event
                reason = f"a gateway answers {event.status}"
            else:
                assert isinstance(event, Lost)
                self.was_reached |= event.reached
                reason = event.reason
            pause = next(pauses, None)
            if pause is None or not self.was_reached:
                raise ServiceUnreachable(f"the service cannot be reached: {reason}")
            yield Pause(pause)

    def ask_until_taken(self, request: Request) -> Conversation[Reply]:
        """The reply, after as many refusals for now as there are."""
        while (reply := (yield from self.ask(request))).is_refusal_for_now:
            yield Pause(reply.retry_after)
        return reply

    def wait_for(self, ticket: Ticket, wait: float) -> Conversation[Reply]:
        """The reply to a ticket, for which the service is asked to wait; who answers early is left alone a while."""
        began = self.clock()
        reply = yield from self.ask_until_taken(ticket.request(wait))
        if reply.status == 202 and self.clock() - began < wait / 2:
            yield Pause(min(wait, PAUSE_WITHOUT_WAIT))
        return reply

    def _pauses(self) -> Iterator[float]:
        pause, paused = FIRST_PAUSE, 0.0
        while paused < self.patience:
            yield pause
            paused += pause
            pause = min(2 * pause, LONGEST_PAUSE)


class Ticket:
    """One problem on its way: the request that solves it, and the name of the solve once that is known."""

    def __init__(self, body: bytes, fields: Sequence[str]) -> None:
        self.body = body
        self.key = str(uuid.uuid4())
        self.fields = fields
        self.index: int | None = None  # its place among those of a map
        self.id: str | None = None
        self.losses = 0

    def request(self, wait: float) -> Request:
        query = urlencode({"wait": f"{wait:.3f}", "fields": ",".join(self.fields)}, safe=",")
        return Request("POST", f"/v1/solves?{query}", self.body, {"Idempotency-Key": self.key}, wait)

    def result(self, reply: Reply) -> Result | None:
        """The result if the solve has ended. Raises Refused, BadReply, and ResultsDropped if that happens often.

        A key under which the service knows nothing any more begins a new solve: what it had found was dropped.
        """
        if reply.status >= 400:
            refusal = reply.refusal(self.index)
            if not refusal.type.endswith(DROPPED):
                raise refusal
            self._lose()
            return None
        document = reply.document(id=str, status=str)
        if self.id not in (None, document["id"]):
            self._lose()
        self.id = document["id"]
        return Result(document) if reply.status == 200 else None

    def _lose(self) -> None:
        self.id = None
        self.losses += 1
        if self.losses > MOST_LOSSES:
            what = "the solve" if self.index is None else f"problem {self.index}"
            raise ResultsDropped(
                f"the service dropped what it had found for {what} before it could be fetched, {self.losses} times: "
                "it keeps too little (--keep-bytes, --keep-seconds), or somebody deletes its solves"
            )
        warnings.warn(
            "the service dropped a result before it could be fetched, and solves the problem again: it keeps too "
            "little (--keep-bytes, --keep-seconds), lost its memory, or somebody deletes its solves",
            RuntimeWarning,
            stacklevel=2,
        )


def solve(line: Line, ticket: Ticket) -> Conversation[Result]:
    """Solves one problem; it is cancelled if the conversation is interrupted."""
    try:
        while True:
            reply = yield from line.wait_for(ticket, LONGEST_WAIT)
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
        """Learns the names. Raises Refused, BadReply."""
        document = reply.document(id=str, solves=list)
        self.id, self.solves = document["id"], document["solves"]

    def path(self) -> str:
        return f"/v1/batches/{quote(str(self.id), safe='')}"

    def results(self) -> Request:
        """Asks for all results, which come as the solves end."""
        path = f"{self.path()}/results?" + urlencode({"fields": ",".join(self.fields)}, safe=",")
        return Request("GET", path, headers={"Accept": CBOR_SEQUENCE}, wait=self.LONGEST_SILENCE)


def solve_batch(line: Line, ticket: BatchTicket) -> Conversation[list[Result]]:
    """Solves the problems of a batch, in order; all are cancelled if the conversation is interrupted."""
    try:
        ticket.read((yield from line.ask_until_taken(ticket.request())))
        reply = yield from line.ask_until_taken(ticket.results())
        documents = reply.documents(id=str, status=str)
        results = {document["id"]: Result(document) for document in documents}
        if gone := [str(place) for place, id in enumerate(ticket.solves) if id not in results]:
            raise ResultsDropped(
                f"the service dropped the results of the problems {', '.join(gone)} of the batch before they could be "
                "fetched: it keeps too little (--keep-bytes), or somebody deletes its solves; map fetches them earlier"
            )
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
        event = yield _in_haste(ticket.request())
        if isinstance(event, Reply):
            with contextlib.suppress(SignoriniError):
                ticket.read(event)
    if ticket.id is not None:
        yield _in_haste(Request("DELETE", ticket.path()))


def solve_all(line: Line, tickets: Sequence[Ticket], tell: Callable[[int], None]) -> Conversation[list[Result]]:
    """Solves all problems, in order, and tells how many are done; all are cancelled if it is interrupted."""
    for index, ticket in enumerate(tickets):
        ticket.index = index
    batch, told = _Batch(line, tickets), 0
    try:
        while len(batch.results) < len(tickets):
            if batch.may_look():
                yield from batch.look()
            elif batch.may_send():
                yield from batch.send()
            else:
                yield from batch.fetch()
            if len(batch.results) > told:
                tell(told := len(batch.results))
        return [batch.results[ticket] for ticket in tickets]
    except GeneratorExit:
        raise
    except BaseException as error:
        yield from _cancel(batch.on_their_way, error)
        raise


class _Batch:
    """Problems that wait, those that the service has, each in the order of the problems, and results.

    The service has more and more until they fill its queue: after a refusal, which says how long that is, a quarter
    less. Where it drops results before they are fetched, it has fewer, in the end one. Results come in the order of the
    problems, which is about that in which they end; what has ended long before its turn is looked for now and then.
    """

    def __init__(self, line: Line, tickets: Sequence[Ticket]) -> None:
        self.line = line
        self.clock = line.clock
        self.waiting = deque(tickets)
        self.on_their_way: list[Ticket] = []
        self.results: dict[Ticket, Result] = {}
        self.window = SMALLEST_WINDOW
        self.largest_window = LARGEST_WINDOW
        self.smallest_window = SMALLEST_WINDOW
        self.sent_before_loss: set[Ticket] = set()
        self.closed_until = self.clock()
        self.look_pause = FIRST_LOOK
        self.next_look = self.clock() + FIRST_LOOK

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
        self.closed_until = self.clock() + reply.retry_after
        while self.on_their_way and (yield from self._fetch(self.on_their_way[0], 0.0)):
            pass
        self.largest_window = max(min(self.window, len(self.on_their_way)) * 3 // 4, self.smallest_window)
        self.window = self.largest_window

    def fetch(self) -> Conversation[None]:
        """Waits for the first result that is missing, but no longer than until there is something else to do."""
        has_more_to_send = self.waiting and len(self.on_their_way) < self.window
        wait = max(self.closed_until - self.clock(), 0.0) if has_more_to_send else LONGEST_WAIT
        if not self.on_their_way:
            yield Pause(wait)
            return
        if len(self.on_their_way) > 1:
            wait = min(wait, max(self.next_look - self.clock(), 0.0))
        yield from self._fetch(self.on_their_way[0], min(wait, LONGEST_WAIT))

    def may_look(self) -> bool:
        return len(self.on_their_way) > 1 and self.clock() >= self.next_look

    def look(self) -> Conversation[None]:
        """Fetches what has ended before its turn, so that the service may drop it."""
        reply = yield from self.line.ask(Request("GET", f"/v1/solves?limit={2 * len(self.on_their_way)}"))
        ended = _ended(reply) if reply.status < 400 else set()  # a token may allow solving alone
        found = [ticket for ticket in self.on_their_way if ticket.id in ended]
        for ticket in found:
            yield from self._fetch(ticket, 0.0)
        self.look_pause = FIRST_LOOK if found else min(2 * self.look_pause, LONGEST_WAIT)
        self.next_look = self.clock() + self.look_pause

    def _fetch(self, ticket: Ticket, wait: float) -> Conversation[bool]:
        """Whether its result came."""
        return self._read(ticket, (yield from self.line.wait_for(ticket, wait)))

    def _read(self, ticket: Ticket, reply: Reply) -> bool:
        losses = ticket.losses
        result = ticket.result(reply)
        if ticket.losses > losses and ticket not in self.sent_before_loss:
            self._take_less()
        if result is None:
            return False
        self.on_their_way.remove(ticket)
        self.results[ticket] = result
        self.window = min(self.window + 1, self.largest_window)
        return True

    def _take_less(self) -> None:
        """Gives a service less from now on that has dropped something, and looks at once for what else has ended."""
        self.next_look = self.clock()
        self.sent_before_loss = set(self.on_their_way)
        self.smallest_window = 1
        self.largest_window = max(min(self.window, len(self.on_their_way)) // 4, 1)
        self.window = self.largest_window


def _ended(reply: Reply) -> set[str]:
    """The names of the solves of a list that have ended."""
    solves = [solve for solve in reply.document(solves=list)["solves"] if isinstance(solve, dict)]
    return {str(solve.get("id")) for solve in solves if solve.get("status") in ENDED}


def _in_haste(request: Request) -> Request:
    """The request of somebody who leaves."""
    return replace(request, patience=PATIENCE_TO_CANCEL)


def _cancel(tickets: Iterable[Ticket], error: BaseException) -> Conversation[None]:
    """Cancels what the service may have of these, without patience; the error says why."""
    if isinstance(error, ServiceUnreachable):
        return
    for ticket in tickets:
        if ticket.id is None and not isinstance(error, Refused) and not (yield from _learn_id(ticket)):
            return
        if ticket.id is not None:
            path = f"/v1/solves/{quote(ticket.id, safe='')}"
            if not isinstance((yield _in_haste(Request("DELETE", path))), Reply):
                return


def _learn_id(ticket: Ticket) -> Conversation[bool]:
    """Whether a request has arrived whose reply was not read, only its repetition tells; whether that was answered."""
    event = yield _in_haste(ticket.request(wait=0.0))
    if not isinstance(event, Reply):
        return False
    with contextlib.suppress(SignoriniError):
        ticket.result(event)
    return True


def list_solves(line: Line, request: Request) -> Conversation[list[dict[str, Any]]]:
    """The status documents of all pages, newest first. Raises Refused, BadReply."""
    solves: list[dict[str, Any]] = []
    seen = {request.path}
    while True:
        reply = yield from line.ask_until_taken(request)
        page = reply.document(solves=list, links=dict)
        solves += page["solves"]
        following = page["links"].get("next")
        if following is None:
            return solves
        if not isinstance(following, str) or not re.fullmatch("/[!-~]*", following) or following in seen:
            raise reply.bad(f"it cannot be followed by {following!r}")
        seen.add(following)
        request = Request("GET", following)


def list_examples(line: Line, request: Request) -> Conversation[list[str]]:
    """The names of the examples. Raises Refused, BadReply."""
    reply = yield from line.ask_until_taken(request)
    names = [each.get("name") if isinstance(each, dict) else each for each in reply.document(examples=list)["examples"]]
    if not all(isinstance(name, str) for name in names):
        raise reply.bad("an example has no name")
    return names


def ask(line: Line, request: Request, **members: type) -> Conversation[dict[str, Any]]:
    """The document of a reply, which has these members, of these types. Raises Refused, BadReply."""
    return (yield from line.ask_until_taken(request)).document(**members)
