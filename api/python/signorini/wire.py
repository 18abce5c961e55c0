"""What the sockets of both clients have in common: how a reply is read, and what it means that there is none."""

from __future__ import annotations

import http.client
import io
import re
import socket
import ssl
from collections.abc import Iterator
from typing import cast

from .endpoint import Endpoint
from .errors import BadReply, ServiceUnreachable
from .exchange import Hopeless, Lost, Reply, Request

#: Bytes that are read at once; what a reply announces is not believed before it comes.
PIECE = 1 << 18
_LONGEST_HEAD = 1 << 20  # bytes
#: What either client meets where there is no reply.
MISHAPS = (OSError, http.client.HTTPException)


def read(endpoint: Endpoint, request: Request, response: http.client.HTTPResponse) -> Reply:
    """The reply whose head is read already. Raises OSError, and HTTPException if it ends too early."""
    body = b"".join(_pieces(response))
    missing = response.length
    # http.client takes a head that is cut off for a whole one.
    if missing or (missing is None and not response.chunked and not body):
        raise http.client.IncompleteRead(b"", missing)
    headers = {name.lower(): value for name, value in response.getheaders()}
    return Reply(response.status, headers, body, source(endpoint, request))


def _pieces(response: http.client.HTTPResponse) -> Iterator[bytes]:
    try:
        while piece := response.read(PIECE):
            yield piece
    except ValueError as error:
        raise http.client.HTTPException(f"a chunk has no length: {error}") from error


def source(endpoint: Endpoint, request: Request) -> str:
    """What is asked for where."""
    return f"{request.method} {endpoint.url.rstrip('/')}{request.path}"


def mishap(endpoint: Endpoint, request: Request, error: Exception, reached: bool) -> Lost | Hopeless:
    """What one of MISHAPS means; `reached` says whether the head of a reply had come."""
    if isinstance(error, ssl.SSLError) and not isinstance(error, (ssl.SSLEOFError, ssl.SSLZeroReturnError)):
        hint = " (does it speak http:// there?)" if error.reason in ("WRONG_VERSION_NUMBER", "HTTP_REQUEST") else ""
        return Hopeless(ServiceUnreachable(f"there is no TLS with {endpoint.url}: {error}{hint}"))
    if isinstance(error, http.client.HTTPException) and not _is_cut_off(error):
        hint = " (does it speak https:// there?)" if str(error).startswith("\x15") else ""  # as an alert of TLS does
        said = f"was answered by what is no HTTP: {_shortened(error)}{hint}"
        return Hopeless(BadReply(f"{source(endpoint, request)} {said}"))
    return Lost(f"{endpoint.url}: {_shortened(error)}", reached)


def _is_cut_off(error: http.client.HTTPException) -> bool:
    """Whether it tells of a reply that has ended early, and not of one that is none."""
    if isinstance(error, http.client.BadStatusLine) and not isinstance(error, http.client.RemoteDisconnected):
        line = str(error.args[0])
        return not line.endswith("\n") and line[:5] == "HTTP/"[: len(line)]
    return isinstance(error, (http.client.IncompleteRead, http.client.RemoteDisconnected))


def _shortened(error: Exception) -> str:
    said = repr(error)
    return said if len(said) < 300 else said[:300] + "…"


class Inbox:
    """The bytes of a reply as they come, and whether more of them are needed."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.bytes = bytearray()
        self.end: float | None = None  # how many there are, once the head says so

    def is_whole(self) -> bool:
        """Whether nothing more is needed; what is no HTTP is."""
        if self.end is None:
            self.end = self._told_end()
        return self.end is not None and len(self.bytes) >= self.end

    def has_head(self) -> bool:
        """Whether the head has come."""
        return re.search(rb"\n\r?\n", self.bytes[:_LONGEST_HEAD]) is not None

    def _told_end(self) -> float | None:
        head = re.search(rb"\n\r?\n", self.bytes)
        while head and re.match(rb"HTTP/1\.. 100 ", self.bytes):
            del self.bytes[: head.end()]  # "Continue" says nothing
            head = re.search(rb"\n\r?\n", self.bytes)
        is_http = self.bytes[:5] == b"HTTP/"[: len(self.bytes)] or not self.bytes
        if not head:
            return 0 if (not is_http and b"\n" in self.bytes) or len(self.bytes) > _LONGEST_HEAD else None
        response = self.response()
        try:
            response.begin()
        except http.client.HTTPException:
            return 0
        return float("inf") if response.length is None else head.end() + response.length

    def response(self) -> http.client.HTTPResponse:
        """What has come as a response of http.client, before its head is read."""
        return http.client.HTTPResponse(cast(socket.socket, _Received(bytes(self.bytes))), method=self.request.method)


class _Received:
    """Bytes in the place of a socket, of which http.client reads a reply."""

    def __init__(self, received: bytes) -> None:
        self.received = received

    def makefile(self, mode: str) -> io.BytesIO:
        return io.BytesIO(self.received)
