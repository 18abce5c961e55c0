"""A client of the service that waits."""

from __future__ import annotations

import http.client
import ssl
import time
from collections.abc import Iterable, Sequence
from typing import Any

from . import conversation, questions, wire
from .conversation import Line, checked_patience
from .document import read
from .endpoint import Endpoint
from .exchange import Answer, Conversation, Event, Request, Step
from .questions import AnyProblem, Progress
from .result import Result
from .summary import Estimate


class Client:
    """A service at an address, by default that of the environment variable SIGNORINI_URL, or port 8080 of this machine.

    `token` is one of the service's, if it wants one; `context` is for https. A service that has answered a call and
    does not answer any more is tried for `patience` seconds, then ServiceUnreachable is raised; one that never answered
    raises it at once, and so does one without TLS that is trusted. BadReply is raised at once where something else than
    a service answers. Variables of the environment that name proxies are not read. A client has no connection of its
    own and may be used by several threads. Raises ValueError for an address, a token or a patience that is none.
    """

    def __init__(
        self,
        url: str | None = None,
        *,
        token: str | None = None,
        patience: float = 60.0,
        context: ssl.SSLContext | None = None,
    ) -> None:
        self._endpoint = Endpoint(url, token)
        self._patience = checked_patience(patience)
        self._context = context

    def solve(self, problem: AnyProblem, *, fields: Sequence[str] | None = None) -> Result:
        """Solves a problem and waits for its result.

        `fields` names the members of the result besides `summary`; by default all that there are. A full queue is
        waited for. Ctrl-C cancels the solve. Raises SolveFailed, whose `result` has the last iterate, Refused with the
        faults of a bad problem, ServiceUnreachable, BadReply, and TypeError or ValueError, with a JSON pointer, for
        what JSON does not have.
        """
        return self._run(conversation.solve(self._line(), questions.ticket(problem, fields))).check()

    def map(
        self, problems: Iterable[AnyProblem], *, fields: Sequence[str] | None = None, progress: Progress = False
    ) -> list[Result]:
        """Solves many problems and returns their results in the same order.

        The queue of the service is filled until it is full, then kept at three quarters. After 503 nothing is added
        within `Retry-After`, of which 0.1 to 300 s are believed; after a lost connection and a restart of the service
        all goes on, and nothing is solved twice while the service keeps it. What it drops before that is fetched is
        solved again with a RuntimeWarning; ResultsDropped is raised if that happens to a problem for the third time.
        `progress=True` shows a bar; a function is called with how many are done and how many there are. A solve
        that fails raises nothing here: its result has the `status` `failed`, and `check()`. Ctrl-C cancels what was not
        fetched. Raises Refused, with the `index` of the bad problem, after the others were cancelled, and
        ServiceUnreachable.
        """
        tickets = questions.tickets(problems, fields)
        return self._run(conversation.solve_all(self._line(), tickets, questions.teller(progress, len(tickets))))

    def batch(
        self,
        problems: Iterable[AnyProblem],
        *,
        title: str | None = None,
        tags: Sequence[str] | None = None,
        fields: Sequence[str] | None = None,
    ) -> list[Result]:
        """Solves problems that are accepted or refused as a whole, and returns their results in the same order.

        One request posts them and one fetches the results, so that they must fit into the queue together; `map` is for
        any number of them. `tags` are those of each problem, beside its own. Ctrl-C cancels all. A solve that fails
        raises nothing here, as in `map`. Raises Refused, with pointers such as `/problems/3/load`,
        ServiceUnreachable, and ResultsDropped if some were dropped before they were fetched.
        """
        return self._run(conversation.solve_batch(self._line(), questions.batch(problems, title, tags, fields)))

    def solves(
        self, *, tag: str | None = None, title: str | None = None, status: str | None = None
    ) -> list[dict[str, Any]]:
        """The status documents of the solves with this tag, a part of this title, and this status; newest first."""
        return self._run(conversation.list_solves(self._line(), questions.solves(tag, title, status)))

    def delete_tagged(self, tag: str, count: int) -> dict[str, int]:
        """Cancels and deletes the `count` solves with a tag, and tells how many were `cancelled` and `deleted`.

        Raises Refused (409) and does nothing if they are not so many: `len(client.solves(tag=…))` is their number.
        """
        dismissed: dict[str, int] = self._ask(questions.deletion(tag, count), cancelled=int, deleted=int)
        return dismissed

    def result(self, id: str, *, fields: Sequence[str] | None = None) -> Result:
        """The result of an earlier solve. Raises Refused if there is none (404, 410) or not yet (409)."""
        return Result(self._ask(questions.result(id, fields), id=str, status=str))

    def validate(self, problem: AnyProblem) -> Estimate:
        """Sizes of a problem and what it would cost. Raises Refused with its faults."""
        document = self._ask(questions.validation(problem), unknowns=dict, estimated=dict)
        estimate: Estimate = read(Estimate, document)
        return estimate

    def examples(self) -> list[str]:
        """The names of the examples of the service."""
        return self._run(conversation.list_examples(self._line(), questions.examples()))

    def example(self, name: str) -> dict[str, Any]:
        """An example as a document, which can be changed and solved. Raises Refused if there is none of this name."""
        return self._ask(questions.example(name))

    def _line(self) -> Line:
        return Line(self._patience)

    def _ask(self, request: Request, **members: type) -> dict[str, Any]:
        return self._run(conversation.ask(self._line(), request, **members))

    def _run(self, talk: Conversation[Answer]) -> Answer:
        connection = _Connection(self._endpoint, self._context)
        try:
            step = next(talk)
            while True:
                try:
                    event = connection.do(step)
                except BaseException as interruption:
                    connection.close()
                    step = talk.throw(interruption)
                else:
                    step = talk.send(event)
        except StopIteration as end:
            answer: Answer = end.value
            return answer
        finally:
            connection.close()


class _Connection:
    """Does the steps of one conversation by one connection, which is opened again when it is lost."""

    def __init__(self, endpoint: Endpoint, context: ssl.SSLContext | None) -> None:
        self.endpoint = endpoint
        self.http: http.client.HTTPConnection
        if endpoint.is_secure:
            self.http = http.client.HTTPSConnection(endpoint.host, endpoint.port, context=context)
        else:
            self.http = http.client.HTTPConnection(endpoint.host, endpoint.port)

    def close(self) -> None:
        self.http.close()

    def do(self, step: Step) -> Event:
        if not isinstance(step, Request):
            time.sleep(step.seconds)
            return None
        reached, was_used = False, self.http.sock is not None
        try:
            with self.response(step) as response:
                reached = True
                return wire.read(self.endpoint, step, response)
        except wire.MISHAPS as error:
            self.close()
            if was_used and not reached and isinstance(error, ConnectionError):
                return self.do(step)  # a service may close a connection on which it has answered at any time
            return wire.mishap(self.endpoint, step, error, reached)

    def response(self, request: Request) -> http.client.HTTPResponse:
        """The head of the reply."""
        if self.http.sock is None:
            self.http.timeout = request.patience
            self.http.connect()
        assert self.http.sock is not None
        self.http.sock.settimeout(request.timeout)
        path, headers = self.endpoint.path(request), self.endpoint.headers(request)
        self.http.request(request.method, path, request.body or None, headers)
        return self.http.getresponse()
