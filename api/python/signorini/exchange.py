"""Requests and what comes of them, as values: nothing here reads or writes a socket."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from datetime import timezone
from email.utils import parsedate_to_datetime
from typing import Any, TypeVar, Union

from . import cbor
from .errors import BadReply, Fault, Refused, SignoriniError

CBOR = "application/cbor"
CBOR_SEQUENCE = "application/cbor-seq"
JSON = "application/json"
#: Seconds that a reply may take beyond those that were asked for.
PATIENCE_FOR_A_REPLY = 60.0
#: What stands between client and service answers so while there is no service behind it.
GATEWAY_STATUSES = (502, 503, 504)
#: Seconds after which a request that was refused for now is repeated, if none or no sensible time was told.
USUAL_PAUSE = 5.0
#: Seconds between which every such pause is.
SHORTEST_PAUSE, LONGEST_PAUSE = 0.1, 300.0
_SHOWN = 120  # bytes of a reply that is not understood


@dataclass(frozen=True)
class Request:
    """An HTTP request; `path` is below the address of the service."""

    method: str
    path: str
    body: bytes = b""
    headers: Mapping[str, str] = field(default_factory=dict)
    wait: float = 0.0  #: seconds that the service is asked to wait before it replies
    patience: float = PATIENCE_FOR_A_REPLY  #: seconds in which something must come beyond these

    @property
    def timeout(self) -> float:
        """Seconds in which something must come, again and again until all is there."""
        return self.wait + self.patience


@dataclass(frozen=True)
class Reply:
    """An HTTP reply; the names of headers are in lower case, `source` says what it is the reply to."""

    status: int
    headers: Mapping[str, str]
    body: bytes
    source: str = "the service"

    @property
    def retry_after(self) -> float:
        """Seconds after which to ask again: those of `Retry-After`, which may be an HTTP date, from 0.1 to 300.

        Where there is none, or what it says is neither seconds nor a date, they are 5.
        """
        seconds = _seconds(self.headers.get("retry-after", "").strip(), self.headers.get("date", ""))
        return USUAL_PAUSE if seconds is None else min(max(seconds, SHORTEST_PAUSE), LONGEST_PAUSE)

    @property
    def is_refusal_for_now(self) -> bool:
        """Whether the same request may be taken later: 429, or 503 with `Retry-After`, whatever that says."""
        return self.status == 429 or (self.status == 503 and "retry-after" in self.headers)

    @property
    def is_from_no_service(self) -> bool:
        """Whether a gateway says that there is nothing behind it."""
        return self.status in GATEWAY_STATUSES and not self.is_refusal_for_now

    def document(self, **members: type) -> dict[str, Any]:
        """What the body says, an object that has these members, of these types.

        Raises Refused for a status of 400 and more, BadReply if it is anything else.
        """
        return self._expected(self._read(cbor.loads if self._is_cbor() else json.loads), members)

    def documents(self, **members: type) -> list[dict[str, Any]]:
        """What the body says, a CBOR sequence of such objects. Raises as `document` does."""
        return [self._expected(each, members) for each in self._read(cbor.loads_all)]

    def _is_cbor(self) -> bool:
        return self.headers.get("content-type", "").split(";")[0].strip().lower() == CBOR

    def _read(self, read: Any) -> Any:
        if self.status >= 400:
            raise self.refusal()
        if self.status >= 300:
            raise self.bad(f"it leads elsewhere, to {self.headers.get('location', 'nowhere')!r}")
        try:
            return read(self.body)
        except (ValueError, RecursionError) as error:
            raise self.bad(str(error)) from error

    def _expected(self, document: Any, members: Mapping[str, type]) -> dict[str, Any]:
        if not isinstance(document, dict) or not all(isinstance(name, str) for name in document):
            raise self.bad("it is no object")
        for name, kind in members.items():
            if not isinstance(document.get(name), kind):
                raise self.bad(f"its member {name} is missing or no {kind.__name__}")
        return document

    def bad(self, why: str) -> BadReply:
        """That it is none of the replies of a service."""
        kind = self.headers.get("content-type", "no type")
        begin = f"{self.body[:_SHOWN]!r}{'…' if len(self.body) > _SHOWN else ''}"
        return BadReply(
            f"{self.source} was answered by {self.status} ({kind}) with what no service of Signorini says: {why}. "
            f"It begins {begin}"
        )

    def refusal(self, index: int | None = None) -> Refused:
        """Why the service refuses; `index` is the place of the problem among several."""
        try:
            details = json.loads(self.body)
        except (ValueError, RecursionError):
            details = None
        if not isinstance(details, dict) or "title" not in details:
            details = {"detail": f"{self.source} was answered by {self.body[:_SHOWN]!r}"}
        return refused(details, self.status, index)


def _seconds(text: str, date: str) -> float | None:
    """What `Retry-After` says; a date is compared with that of the reply, or else the clock of this machine."""
    if re.fullmatch(r"[0-9]+(\.[0-9]+)?", text):
        return float(text)
    then = _instant(text)
    if then is None:
        return None
    now = _instant(date)
    return then - (time.time() if now is None else now)


def _instant(text: str) -> float | None:
    try:
        at = parsedate_to_datetime(text)
        return (at if at.tzinfo else at.replace(tzinfo=timezone.utc)).timestamp()
    except (ValueError, TypeError, OverflowError):
        return None


def refused(details: Mapping[str, Any], status: int | None, index: int | None = None) -> Refused:
    """The error that the members of a problem document (RFC 9457) describe."""
    errors = details.get("errors")
    faults = tuple(
        Fault(str(fault.get("detail", "")), fault.get("pointer"), fault.get("parameter"))
        for fault in (errors if isinstance(errors, list) else [])
        if isinstance(fault, dict)
    )
    kind = str(details.get("type", "about:blank"))
    title = str(details.get("title", f"HTTP status {status}"))
    return Refused(status, kind, title, str(details.get("detail", "")), faults, index)


@dataclass(frozen=True)
class Lost:
    """There was no whole reply. `reached` says whether one had begun to come."""

    reason: str
    reached: bool


@dataclass(frozen=True)
class Hopeless:
    """There was no reply, nor would there be to the same request again; `error` says why."""

    error: SignoriniError


@dataclass(frozen=True)
class Pause:
    """Nothing to do for so many seconds."""

    seconds: float


Step = Union[Request, Pause]
Event = Union[Reply, Lost, Hopeless, None]
Answer = TypeVar("Answer")
#: Yields what is to be done and is sent what came of it: a Reply, Lost or Hopeless for a Request, None for a Pause. It
#: returns its answer. What is raised while a step is done is thrown into it.
Conversation = Generator[Step, Event, Answer]
