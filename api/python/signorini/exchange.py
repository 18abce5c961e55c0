"""Requests and what comes of them, as values: nothing here reads or writes a socket."""

from __future__ import annotations

import json
import os
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar, Union
from urllib.parse import urlsplit

from . import cbor
from .errors import Fault, Refused

CBOR = "application/cbor"
CBOR_SEQUENCE = "application/cbor-seq"
JSON = "application/json"
#: Seconds that a reply may take beyond those that were asked for.
PATIENCE_FOR_A_REPLY = 60.0
#: What stands between client and service answers so while there is no service behind it.
GATEWAY_STATUSES = (502, 503, 504)


@dataclass(frozen=True)
class Request:
    """An HTTP request; `path` is below the address of the service."""

    method: str
    path: str
    body: bytes = b""
    headers: Mapping[str, str] = field(default_factory=dict)
    wait: float = 0.0  #: seconds that the service is asked to wait before it replies

    @property
    def timeout(self) -> float:
        """Seconds in which something must come."""
        return self.wait + PATIENCE_FOR_A_REPLY


@dataclass(frozen=True)
class Reply:
    """An HTTP reply; the names of headers are in lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def retry_after(self) -> float | None:
        """Seconds after which the service wants to be asked again, if it says so."""
        seconds = self.headers.get("retry-after", "")
        return float(seconds) if seconds.isdigit() else None

    @property
    def is_refusal_for_now(self) -> bool:
        """Whether the same request may be taken later: 429 or 503 with `Retry-After`."""
        return self.status in (429, 503) and self.retry_after is not None

    @property
    def is_from_no_service(self) -> bool:
        """Whether a gateway says that there is nothing behind it."""
        return self.status in GATEWAY_STATUSES and self.retry_after is None

    def document(self) -> Any:
        """What the body says. Raises Refused for a status of 400 and more."""
        if self.status >= 400:
            raise self.refusal()
        return cbor.loads(self.body) if self.headers.get("content-type", "").startswith(CBOR) else json.loads(self.body)

    def documents(self) -> list[Any]:
        """What the body says, a CBOR sequence. Raises Refused for a status of 400 and more."""
        if self.status >= 400:
            raise self.refusal()
        return cbor.loads_all(self.body)

    def refusal(self, index: int | None = None) -> Refused:
        """Why the service refuses; `index` is the place of the problem among several."""
        try:
            details = json.loads(self.body)
        except ValueError:
            details = {}
        return refused(details if isinstance(details, dict) else {}, self.status, index)


def refused(details: Mapping[str, Any], status: int | None, index: int | None = None) -> Refused:
    """The error that the members of a problem document (RFC 9457) describe."""
    faults = tuple(
        Fault(fault["detail"], fault.get("pointer"), fault.get("parameter")) for fault in details.get("errors", [])
    )
    title = details.get("title", f"HTTP status {status}")
    return Refused(status, details.get("type", "about:blank"), title, details.get("detail", ""), faults, index)


@dataclass(frozen=True)
class Lost:
    """There was no reply. `sent` says whether the request may have arrived all the same."""

    reason: str
    sent: bool


@dataclass(frozen=True)
class Pause:
    """Nothing to do for so many seconds."""

    seconds: float


Step = Union[Request, Pause]
Event = Union[Reply, Lost, None]
Answer = TypeVar("Answer")
#: Yields what is to be done and is sent what came of it: a Reply or Lost for a Request, None for a Pause. It returns
#: its answer. What is raised while a step is done is thrown into it.
Conversation = Generator[Step, Event, Answer]


class Endpoint:
    """Where a service is, and how it is spoken to; without `url` where SIGNORINI_URL says, or on this machine.

    Raises ValueError for an address that is none of http:// and https://.
    """

    def __init__(self, url: str | None, token: str | None) -> None:
        url = url or os.environ.get("SIGNORINI_URL") or "http://127.0.0.1:8080"
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ValueError(f"{url!r} is no address of a service, such as http://127.0.0.1:8080")
        self.url = url
        self.is_secure = parts.scheme == "https"
        self.host = parts.hostname
        self.port = parts.port or (443 if self.is_secure else 80)
        self.prefix = parts.path.rstrip("/")
        self.token = token

    def path(self, request: Request) -> str:
        """The path of a request on the host."""
        return self.prefix + request.path

    def headers(self, request: Request) -> dict[str, str]:
        """All headers of a request but those of its framing."""
        headers = {"Accept": f"{CBOR}, {JSON};q=0.9", **request.headers}
        if request.body:
            headers["Content-Type"] = JSON
        if self.token is not None:
            headers["Authorization"] = f"Bearer {self.token}"
        return headers
