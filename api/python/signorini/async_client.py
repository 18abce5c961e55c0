"""The asyncio twin of the client: it has the same conversations, and other hands."""

from __future__ import annotations

import asyncio
import ssl
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


class AsyncClient:
    """A service at an address; every call does what that of `Client` does, and its parameters are the same.

    Where a call is cancelled, its solves are. `asyncio.gather` over `solve` waits for many at once; for a full queue
    `map` is better. Every request has a connection of its own.
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
        self._context = context or (ssl.create_default_context() if self._endpoint.is_secure else None)

    async def solve(self, problem: AnyProblem, *, fields: Sequence[str] | None = None) -> Result:
        """Solves a problem; see `Client.solve`."""
        return (await self._run(conversation.solve(self._line(), questions.ticket(problem, fields)))).check()

    async def map(
        self, problems: Iterable[AnyProblem], *, fields: Sequence[str] | None = None, progress: Progress = False
    ) -> list[Result]:
        """Solves many problems; see `Client.map`."""
        tickets = questions.tickets(problems, fields)
        return await self._run(conversation.solve_all(self._line(), tickets, questions.teller(progress, len(tickets))))

    async def batch(
        self,
        problems: Iterable[AnyProblem],
        *,
        title: str | None = None,
        tags: Sequence[str] | None = None,
        fields: Sequence[str] | None = None,
    ) -> list[Result]:
        """Solves problems as a whole; see `Client.batch`."""
        return await self._run(conversation.solve_batch(self._line(), questions.batch(problems, title, tags, fields)))

    async def solves(
        self, *, tag: str | None = None, title: str | None = None, status: str | None = None
    ) -> list[dict[str, Any]]:
        """Status documents; see `Client.solves`."""
        return await self._run(conversation.list_solves(self._line(), questions.solves(tag, title, status)))

    async def delete_tagged(self, tag: str, count: int) -> dict[str, int]:
        """Cancels and deletes solves; see `Client.delete_tagged`."""
        dismissed: dict[str, int] = await self._ask(questions.deletion(tag, count), cancelled=int, deleted=int)
        return dismissed

    async def result(self, id: str, *, fields: Sequence[str] | None = None) -> Result:
        """The result of an earlier solve; see `Client.result`."""
        return Result(await self._ask(questions.result(id, fields), id=str, status=str))

    async def validate(self, problem: AnyProblem) -> Estimate:
        """Sizes of a problem and what it would cost; see `Client.validate`."""
        document = await self._ask(questions.validation(problem), unknowns=dict, estimated=dict)
        estimate: Estimate = read(Estimate, document)
        return estimate

    async def examples(self) -> list[str]:
        """The names of the examples of the service."""
        return await self._run(conversation.list_examples(self._line(), questions.examples()))

    async def example(self, name: str) -> dict[str, Any]:
        """An example as a document; see `Client.example`."""
        return await self._ask(questions.example(name))

    def _line(self) -> Line:
        return Line(self._patience)

    async def _ask(self, request: Request, **members: type) -> dict[str, Any]:
        return await self._run(conversation.ask(self._line(), request, **members))

    async def _run(self, talk: Conversation[Answer]) -> Answer:
        try:
            step = next(talk)
            while True:
                try:
                    event = await self._do(step)
                except BaseException as interruption:
                    step = talk.throw(interruption)
                else:
                    step = talk.send(event)
        except StopIteration as end:
            answer: Answer = end.value
            return answer

    async def _do(self, step: Step) -> Event:
        if not isinstance(step, Request):
            await asyncio.sleep(step.seconds)
            return None
        inbox = wire.Inbox(step)
        try:
            await self._exchange(step, inbox)
            response = inbox.response()
            response.begin()
            return wire.read(self._endpoint, step, response)
        except wire.MISHAPS as error:
            return wire.mishap(self._endpoint, step, error, inbox.has_head())

    async def _exchange(self, request: Request, inbox: wire.Inbox) -> None:
        async with asyncio.timeout(request.patience):
            reader, writer = await asyncio.open_connection(
                self._endpoint.host, self._endpoint.port, ssl=self._context
            )
        try:
            writer.write(_request_bytes(self._endpoint, request))
            while not inbox.is_whole():
                async with asyncio.timeout(request.timeout):
                    piece = await reader.read(wire.PIECE)
                if not piece:
                    return
                inbox.bytes += piece
        finally:
            writer.close()


def _request_bytes(endpoint: Endpoint, request: Request) -> bytes:
    host = endpoint.host if ":" not in endpoint.host else f"[{endpoint.host}]"
    headers = endpoint.headers(request) | {
        "Host": f"{host}:{endpoint.port}",
        "Content-Length": str(len(request.body)),
        "Connection": "close",
    }
    lines = [f"{name}: {text}" for name, text in headers.items()]
    head = "\r\n".join([f"{request.method} {endpoint.path(request)} HTTP/1.1", *lines, "", ""])
    return head.encode("latin-1") + request.body
