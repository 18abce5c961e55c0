"""A server that answers what a test tells it to: bytes of any kind, none, or an end at any place."""

from __future__ import annotations

import re
import socket
import ssl
import struct
import threading
from collections.abc import Callable, Iterable
from typing import Union

#: What is sent to a request, whole or in pieces; None resets the connection.
Script = Union[bytes, Iterable[Union[bytes, None]]]


class HostileServer:
    """Listens on the loopback; `answer(number, request)` is what the request gets, then its connection is closed."""

    def __init__(self, answer: Callable[[int, bytes], Script], *, tls: ssl.SSLContext | None = None) -> None:
        self.answer = answer
        self.tls = tls
        self.requests: list[bytes] = []
        self.lock = threading.Lock()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http{'s' if tls else ''}://127.0.0.1:{self.listener.getsockname()[1]}"
        self.ended = threading.Event()
        threading.Thread(target=self.listen, daemon=True).start()

    def __enter__(self) -> HostileServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.ended.set()
        # Whoever waits for a connection wakes up.
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def listen(self) -> None:
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=[connection], daemon=True).start()

    def serve(self, connection: socket.socket) -> None:
        try:
            with connection if self.tls is None else self.tls.wrap_socket(connection, server_side=True) as stream:
                request = self.receive(stream)
                with self.lock:
                    number = len(self.requests)
                    self.requests.append(request)
                script = self.answer(number, request)
                for piece in [script] if isinstance(script, bytes) else script:
                    if piece is None:
                        stream.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                        return
                    stream.sendall(piece)
        except OSError:
            pass  # the client has left, or spoke no TLS

    def receive(self, stream: socket.socket) -> bytes:
        received = b""
        while not (head := re.search(rb"\r\n\r\n", received)):
            piece = stream.recv(1 << 16)
            if not piece:
                return received
            received += piece
            if received[:1] == b"\x16":  # the beginning of TLS
                return received
        length = re.search(rb"(?i)content-length: *([0-9]+)", received[: head.end()])
        while len(received) < head.end() + int(length[1] if length else 0):
            received += stream.recv(1 << 16)
        return received


def http_reply(
    body: bytes, *, status: str = "200 OK", kind: str = "application/json", headers: Iterable[str] = ()
) -> bytes:
    lines = [f"HTTP/1.1 {status}", f"Content-Type: {kind}", f"Content-Length: {len(body)}", *headers, "", ""]
    return "\r\n".join(lines).encode("latin-1") + body
