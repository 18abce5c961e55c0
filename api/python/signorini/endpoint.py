"""Where a service is, and how it is spoken to."""

from __future__ import annotations

import os
import re
from urllib.parse import urlsplit

from .exchange import CBOR, JSON, Request

_VISIBLE = re.compile("[!-~]+")  # ASCII that shows


class Endpoint:
    """Where a service is; without `url` where SIGNORINI_URL says, or on this machine.

    Raises ValueError for an address that is none of http:// and https://, or has more than a host, a port and a path,
    and for a token that is not of visible ASCII characters.
    """

    def __init__(self, url: str | None, token: str | None) -> None:
        found = url or os.environ.get("SIGNORINI_URL") or "http://127.0.0.1:8080"
        self.url = _visible(found, "an address of a service")
        try:
            parts = urlsplit(self.url)
            scheme, host, port = parts.scheme, parts.hostname, parts.port
            if host and ":" not in host:
                host.encode("idna")  # as sockets do
        except ValueError as error:
            raise self._none_because(str(error)) from error
        if "@" in parts.netloc:
            raise ValueError("an address of a service has no user and no password; a token goes as token=…")
        if scheme not in ("http", "https") or not host:
            raise self._none_because("such as http://127.0.0.1:8080 is one")
        if "?" in self.url or "#" in self.url:
            raise self._none_because("it has no query and no fragment")
        if port == 0:
            raise self._none_because("a port is a number from 1 to 65535")
        self.is_secure = scheme == "https"
        self.host = host
        self.port = port or (443 if self.is_secure else 80)
        self.prefix = parts.path.rstrip("/")
        self.token = None if token is None else _visible(token, "a token")

    def _none_because(self, why: str) -> ValueError:
        return ValueError(f"{self.url!r} is no address of a service: {why}")

    def path(self, request: Request) -> str:
        """The path of a request on the host. Raises ValueError if it would break the line of the request."""
        return _visible(self.prefix + request.path, "a path")

    def headers(self, request: Request) -> dict[str, str]:
        """All headers of a request but those of its framing."""
        headers = {"Accept": f"{CBOR}, {JSON};q=0.9", **request.headers}
        if request.body:
            headers["Content-Type"] = JSON
        if self.token is not None:
            headers["Authorization"] = f"Bearer {self.token}"
        return headers


def _visible(text: object, what: str) -> str:
    """The text. It is not shown in the error, for it may be secret."""
    if not isinstance(text, str):
        raise ValueError(f"{what} is a text, and not {type(text).__name__}")
    if not _VISIBLE.fullmatch(text):
        raise ValueError(f"{what} is made of visible ASCII characters, and has no spaces and no ends of lines")
    return text
