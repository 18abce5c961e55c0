"""The asyncio twin of the client: it has the same conversations, and other hands."""

from __future__ import annotations

import asyncio
import http.client
import io
import socket
import ssl
from collections.abc import Iterable, Sequence
from typing import Any, cast

from . import conversation, questions
from .conversation import Line
from .document import read
from .exchange import Answer, Conversation, Endpoint, Event, Lost, Reply, Request, Step
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
        self._patience = patience
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
        dismissed: dict[str, int] = await self._ask(questions.deletion(tag, count))
        return dismissed

    async def result(self, id: str, *, fields: Sequence[str] | None = None) -> Result:
        """The result of an earlier solve; see `Client.result`."""
        return Result(await self._ask(questions.result(id, fields)))

    async def validate(self, problem: AnyProblem) -> Estimate:
        """Sizes of a problem and what it would cost; see `Client.validate`."""
        estimate: Estimate = read(Estimate, await self._ask(questions.validation(problem)))
        return estimate

    async def examples(self) -> list[str]:
        """The names of the examples of the service."""
        return [example["name"] for example in (await self._ask(questions.examples()))["examples"]]

    async def example(self, name: str) -> dict[str, Any]:
        """An example as a document; see `Client.example`."""
        document: dict[str, Any] = await self._ask(questions.example(name))
        return document

    def _line(self) -> Line:
        return Line(self._patience)

    async def _ask(self, request: Request) -> Any:
        return await self._run(conversation.ask(self._line(), request))

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
        sent = False
        try:
            async with asyncio.timeout(step.timeout):
                reader, writer = await asyncio.open_connection(
                    self._endpoint.host, self._endpoint.port, ssl=self._context
                )
                sent = True
                try:
                    writer.write(_request_bytes(self._endpoint, step))
                    return _reply(step, await reader.read())
                finally:
                    writer.close()
        except (OSError, http.client.HTTPException) as error:
            return Lost(f"{self._endpoint.url}: {error!r}", sent)


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


class _Received:
    """Bytes in the place of a socket, of which http.client reads a reply."""

    def __init__(self, received: bytes) -> None:
        self.received = received

    def makefile(self, mode: str) -> io.BytesIO:
        return io.BytesIO(self.received)


def _reply(request: Request, received: bytes) -> Reply:
    """Raises HTTPException if the connection ended before the reply did."""
    response = http.client.HTTPResponse(cast(socket.socket, _Received(received)), method=request.method)
    response.begin()
    body = response.read()
    return Reply(response.status, {name.lower(): value for name, value in response.getheaders()}, body)
