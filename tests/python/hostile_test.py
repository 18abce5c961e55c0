"""The clients before servers that are none of Signorini, break off, talk garbage, or are given odd questions."""

from __future__ import annotations

import asyncio
import json
import pathlib
import random
import signal
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
from collections.abc import Callable, Iterator
from typing import Any

import cbor2

from hostile_server import HostileServer, Script, http_reply
from signorini import AsyncClient, BadReply, Client, Refused, Result, ResultsDropped, ServiceUnreachable, SignoriniError

PROBLEM: dict[str, Any] = {"model": "membrane"}
#: What every call of a client is, by its name.
CALLS: dict[str, Callable[[Any], Any]] = {
    "solve": lambda client: client.solve(PROBLEM),
    "map": lambda client: client.map([PROBLEM, PROBLEM]),
    "batch": lambda client: client.batch([PROBLEM]),
    "solves": lambda client: client.solves(),
    "delete_tagged": lambda client: client.delete_tagged("tag", 1),
    "result": lambda client: client.result("ID"),
    "validate": lambda client: client.validate(PROBLEM),
    "examples": lambda client: client.examples(),
    "example": lambda client: client.example("name"),
}
GOOD: dict[str, Any] = {
    "id": "A", "status": "succeeded", "solves": [], "links": {"next": None}, "cancelled": 0, "deleted": 0,
    "unknowns": {}, "estimated": {}, "examples": [],
}  # fmt: skip


def ask(kind: type, url: str, call: Callable[[Any], Any], **options: Any) -> Any:
    """What the call comes to by a `Client` or an `AsyncClient`."""
    if kind is Client:
        return call(Client(url, **options))

    async def wait() -> Any:
        return await call(AsyncClient(url, **options))

    return asyncio.run(wait())


def named_calls(name: str) -> list[Callable[[Any], Any]]:
    """What takes a name that goes into an address."""
    return [
        lambda client: client.example(name),
        lambda client: client.result(name, fields=[name]),
        lambda client: client.solves(tag=name),
    ]


def in_turn(scripts: list[Script]) -> Callable[[int, bytes], Script]:
    """One script after the other, and again from the first."""
    return lambda number, request: scripts[number % len(scripts)]


class Hostile(unittest.TestCase):
    def expect_error(
        self, script: Script, error: type[Exception], words: str, *, calls: Any = ("example",), patience: float = 0.0
    ) -> None:
        """Both clients raise the error within seconds, whatever they are asked."""
        with HostileServer(lambda number, request: script) as server:
            for kind in (Client, AsyncClient):
                for call in calls:
                    with self.subTest(f"{kind.__name__}.{call}", script=script if isinstance(script, bytes) else ""):
                        began = time.monotonic()
                        with self.assertRaisesRegex(error, words):
                            ask(kind, server.url, CALLS[call], patience=patience)
                        self.assertLess(time.monotonic() - began, 3)

    def test_what_is_no_service_is_said_to_be_none(self) -> None:
        captive = http_reply(b"<html>Welcome to the airport</html>", kind="text/html")
        where = r"http://127.0.0.1:[0-9]+/v1/.* was answered by "
        for script, words in (
            (captive, where + r"200 \(text/html\) .*<html>Welcome"),
            (http_reply(b"3"), where + r"200 .*it is no object"),
            (http_reply(b"null"), "it is no object"),
            (http_reply(b'[{"id": "A"}]'), "it is no object"),
            (http_reply(b"{"), "Expecting"),
            (http_reply(b'"\x80\x81"'), "decode"),
            (http_reply(b"[" * 100_000), "recursion|object|Expecting"),
            (http_reply(b"9" * 5000), "limit|object"),
            (http_reply(b"", headers=["Location: https://elsewhere/"], status="302 Found"), "elsewhere, to"),
            (http_reply(b"", status="304 Not Modified"), "leads elsewhere, to 'nowhere'"),
            (http_reply(b"\x9f" * 100_000, kind="application/cbor"), "nested too deeply"),
            (http_reply(b"\x5b" + b"\xff" * 8, kind="application/cbor"), "cut off"),
            (http_reply(b"\x9b" + b"\xff" * 8, kind="application/cbor"), "cut off"),
            (http_reply(b"\xbb" + b"\xff" * 8 + b"\x00", kind="application/cbor"), "cut off"),
            (http_reply(b"\xd9\xd9\xf7\xa0", kind="application/cbor"), "tag 55799 is not known"),
            (http_reply(b"\xf8\x20", kind="application/cbor"), "simple value"),
            (http_reply(b"\xa1\x00\x00", kind="application/cbor"), "it is no object"),
            (http_reply(b"\xa1\x61\xff\x00", kind="application/cbor; x=y"), "no UTF-8"),
            (b"SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n", where + "what is no HTTP: .*SSH"),
            (b"\x15\x03\x01\x00\x02\x02\x28\n", "no HTTP.*https://"),
            (b"HTTP/9.9 200 OK\r\n\r\n", "no HTTP"),
            (b"\x00\x00\x12\x04\x00\x00\x00\x00\x00\x00\x03\n", "no HTTP"),
            (http_reply(b"", status="204 No Content"), "answered by 204"),
            (http_reply(b'{"a": "\x01"}'), "control character"),
            (b"HTTP/1.1 abc OK\r\n\r\n", "no HTTP"),
            (b"HTTP/1.1 99999 OK\r\n\r\n", "no HTTP"),
            (b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * 200 + b"\r\n", "no HTTP.*100 headers"),
            (b"HTTP/1.1 200 OK\r\nX: " + b"y" * 100_000 + b"\r\n\r\n", "no HTTP"),
        ):
            self.expect_error(script, BadReply, words, patience=60)
        # Whatever is asked for.
        self.expect_error(captive, BadReply, where, calls=CALLS)
        self.expect_error(http_reply(b"[]"), BadReply, where, calls=CALLS)

    def test_documents_without_their_members_are_refused(self) -> None:
        for call, members in {
            "solve": ("id", "status"), "map": ("id", "status"), "batch": ("id",), "solves": ("solves", "links"),
            "delete_tagged": ("cancelled", "deleted"), "result": ("id", "status"),
            "validate": ("unknowns", "estimated"), "examples": ("examples",),
        }.items():  # fmt: skip
            for member in members:
                without = {name: value for name, value in GOOD.items() if name != member}
                for document in (without, {**GOOD, member: None}, {**GOOD, member: 3.5}):
                    self.expect_error(
                        http_reply(json.dumps(document).encode()), BadReply, f"member {member} is missing", calls=[call]
                    )
        self.expect_error(http_reply(b'{"examples": [3]}'), BadReply, "an example has no name", calls=["examples"])

    def test_a_batch_whose_results_were_dropped_says_which(self) -> None:
        names = http_reply(b'{"id": "B/?", "solves": ["A", "C", "D"]}')
        results = http_reply(cbor2.dumps({"id": "C", "status": "failed"}), kind="application/cbor-seq")
        with HostileServer(in_turn([names, results, http_reply(b"{}")])) as server:
            for kind in (Client, AsyncClient):
                with self.assertRaisesRegex(ResultsDropped, "problems 0, 2 of the batch .*--keep-bytes"):
                    ask(kind, server.url, lambda client: client.batch([PROBLEM] * 3))
            self.assertIn(b"DELETE /v1/batches/B%2F%3F HTTP", server.requests[2])

    def test_a_result_of_another_shape_is_said_to_be_none(self) -> None:
        for member in ("summary", "mesh", "displacement", "stress", "contact", "history", "sweep", "study", "levels",
                       "quantities", "principal", "von_mises", "error_squares"):  # fmt: skip
            fields = {"points": {"a": 1}, "values": "x", "at_centroids": [[1], 2], "space": 1}
            sums = [{"title": "t", "contact": {"force": {}, "all": [1]}, "summary": {"contact": [3], "parts": {"a": 1}}}]
            deep: Any = []
            for _ in range(900):
                deep = [deep]
            rows = [{"rows": 3}, {"rows": [[]], "rates": {}}, {"rows": [{"h": {}}], "rates": []}]
            for wrong in (3, "text", [3, "x"], fields, sums, deep, {"points": deep, "rows": deep}, *rows):
                result = Result({"id": "A", "status": "failed", member: wrong})
                try:
                    getattr(result, member)
                except BadReply as error:
                    self.assertIn("this is no ", str(error))
                self.assertIn("failed", repr(result) + str(result.error))

    def test_refusals_of_other_servers_say_what_came(self) -> None:
        for body, words in (
            (b"<html>nginx</html>", "HTTP status 404: GET http://.*/v1/examples/name was answered by b'<html>nginx"),
            (b"[]", "HTTP status 404"),
            (b'{"title": 3, "errors": 5, "type": []}', "3: "),
            (b'{"title": "T", "errors": [4, {}, {"detail": "d", "pointer": "/p"}]}', "T: \n   \n  /p d"),
            (b"[" * 100_000, "HTTP status 404"),
        ):
            self.expect_error(http_reply(body, status="404 Not Found"), Refused, words, patience=60)

    def test_a_connection_that_ends_without_an_answer_is_said_at_once(self) -> None:
        for script in (b"", b"H", b"HTTP/1.1 2"):
            for end in ((), (None,)):
                self.expect_error((script, *end), ServiceUnreachable, "http://127.0.0.1", calls=["solve"], patience=60)

    def test_a_reply_that_breaks_off_anywhere_is_asked_for_again(self) -> None:
        document = {"id": "A", "status": "succeeded", "contact": {}}
        for whole in (
            http_reply(json.dumps(document).encode()),
            http_reply(cbor2.dumps(document), kind="application/cbor", headers=["Connection: close"]),
            b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
            b'21\r\n{"id": "A", "status": "succeeded"\r\n1\r\n}\r\n0\r\n\r\n',
        ):
            # In a chunked reply nothing of the document is missing without the last chunk.
            ends = range(0, len(whole) - (7 if b"chunked" in whole else 0), 1 if b"cbor" in whole else 3)
            for kind in (Client, AsyncClient):
                # The first reply is whole, and says that the solve goes on.
                for end in ends:
                    going_on = http_reply(b'{"id": "A", "status": "running"}', status="202 Accepted")
                    scripts: list[Script] = [going_on, [whole[:end], None] if end % 2 else whole[:end], whole]
                    with HostileServer(in_turn(scripts)) as server:
                        result = self.solve_in_haste(kind, server.url)
                    self.assertEqual((result.id, result.status, len(server.requests)), ("A", "succeeded", 3), end)

    def solve_in_haste(self, kind: type, url: str) -> Result:
        """A solve whose pauses take no time."""
        with unittest.mock.patch("time.sleep"), unittest.mock.patch("asyncio.sleep", self.no_sleep):
            result: Result = ask(kind, url, CALLS["solve"])
        return result

    @staticmethod
    async def no_sleep(seconds: float) -> None:
        return None

    def test_a_reply_that_always_breaks_off_is_an_error_after_patience(self) -> None:
        document = json.dumps({"id": "A", "status": "succeeded"}).encode()
        for whole in (http_reply(document), http_reply(document, headers=["Connection: close"])):
            self.expect_error(whole[:-1], ServiceUnreachable, "cannot be reached: .*IncompleteRead", patience=0.1)

    def test_random_bytes_are_an_error(self) -> None:
        luck = random.Random(1)
        heads = [b"", b"HTTP/1.1 ", b"HTTP/1.1 200 OK\r\n", b"HTTP/1.1 200 OK\r\nContent-Length: 30\r\n\r\n",
                 b"HTTP/1.1 200 OK\r\nContent-Type: application/cbor\r\n\r\n",
                 b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"]  # fmt: skip
        lengths = [1, 10, 100, 1000] * 10
        scripts: list[Script] = [head + luck.randbytes(length) for head in heads for length in lengths]
        with HostileServer(in_turn(scripts)) as server:
            for kind in (Client, AsyncClient):
                for _ in scripts:
                    with self.assertRaises(SignoriniError):
                        ask(kind, server.url, CALLS["example"], patience=0)

    def test_a_reply_that_announces_more_than_there_is_memory_is_not_believed(self) -> None:
        for length in (10**15, 10**30):
            head = f"HTTP/1.1 200 OK\r\nContent-Length: {length}\r\n\r\n".encode()
            self.expect_error(head + b"{}", ServiceUnreachable, "IncompleteRead")

    def test_a_reply_that_comes_in_drips_is_read(self) -> None:
        whole = http_reply(b'{"model": "membrane"}')

        def drip(number: int, request: bytes) -> Iterator[bytes]:
            for place in range(len(whole)):
                time.sleep(0.002)
                yield whole[place : place + 1]

        with HostileServer(drip) as server:
            for kind in (Client, AsyncClient):
                self.assertEqual(ask(kind, server.url, CALLS["example"]), PROBLEM)

    def test_a_reply_is_read_to_its_end_where_the_connection_stays_open(self) -> None:
        left = threading.Event()

        def stay(number: int, request: bytes) -> Iterator[bytes]:
            yield http_reply(b'{"model": "membrane"}')
            left.wait(10)

        with HostileServer(stay) as server:
            for kind in (Client, AsyncClient):
                began = time.monotonic()
                self.assertEqual(ask(kind, server.url, CALLS["example"]), PROBLEM)
                self.assertLess(time.monotonic() - began, 5)
            left.set()


    def test_every_framing_is_understood(self) -> None:
        document = b'{"model": "membrane"}'
        whole = http_reply(document)
        for script in (
            b"HTTP/1.1 100 Continue\r\n\r\n" * 3 + whole, whole + whole, b"HTTP/1.0 200 OK\r\n\r\n" + document,
            b"HTTP/1.1 200 OK\nContent-Length: 21\n\n" + document,
            b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n15;x=y\r\n" + document + b"\r\n0\r\nX: y\r\n\r\n",
        ):  # fmt: skip
            with HostileServer(in_turn([script])) as server:
                for kind in (Client, AsyncClient):
                    self.assertEqual(ask(kind, server.url, CALLS["example"]), PROBLEM)

    def test_chunks_without_a_length_are_an_error(self) -> None:
        head = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
        for chunk in (b"-15\r\n{}", b"x\r\n{}", b"\r\n", b"f" * 20 + b"\r\n{}"):
            self.expect_error(head + chunk, SignoriniError, "http://127.0.0.1.*(no HTTP|IncompleteRead)")

    def test_a_service_that_says_continue_for_long_is_heard_out(self) -> None:
        def go_on(number: int, request: bytes) -> Iterator[bytes]:
            for _ in range(20):
                yield b"HTTP/1.1 100 Continue\r\n\r\n" * 1000
            yield http_reply(b'{"model": "membrane"}')

        with HostileServer(go_on) as server:
            for kind in (Client, AsyncClient):
                began = time.monotonic()
                self.assertEqual(ask(kind, server.url, CALLS["example"]), PROBLEM)
                self.assertLess(time.monotonic() - began, 3)


class Interruptions(unittest.TestCase):
    """Who leaves a service that says nothing any more is not held up by it."""

    PROGRAM = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import sys; from signorini import Client, conversation; conversation.PATIENCE_TO_CANCEL = 0.1\n"
        "getattr(Client(sys.argv[1]), sys.argv[2])(*{'solve': [{}], 'map': [[{}] * 9], 'batch': [[{}]]}[sys.argv[2]])"
    )

    def answers(self, count: int, left: threading.Event, silent: threading.Event) -> Callable[[int, bytes], Script]:
        """So many replies, then none, and `silent` is told."""

        def answer(number: int, request: bytes) -> Iterator[bytes]:
            if number < count:
                yield http_reply(b'{"id": "A", "status": "queued", "solves": ["A"]}', status="202 Accepted")
            else:
                silent.set()
                left.wait(20)

        return answer

    def test_ctrl_c_in_every_phase_is_short(self) -> None:
        for call, count in (("solve", 1), ("map", 0), ("map", 4), ("batch", 1)):
            left, silent = threading.Event(), threading.Event()
            with self.subTest(call, count=count), HostileServer(self.answers(count, left, silent)) as server:
                command = [sys.executable, "-c", self.PROGRAM, server.url, call]
                with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as child:
                    self.assertTrue(silent.wait(10))
                    began = time.monotonic()
                    child.send_signal(signal.SIGINT)
                    self.assertIn("KeyboardInterrupt", child.communicate(timeout=10)[1])
                    self.assertLess(time.monotonic() - began, 3)
                left.set()

    def test_a_cancelled_task_ends_soon_in_every_phase(self) -> None:
        calls: dict[str, Callable[[AsyncClient], Any]] = {
            "solve": lambda client: client.solve(PROBLEM),
            "map": lambda client: client.map([PROBLEM] * 9),
            "batch": lambda client: client.batch([PROBLEM]),
        }

        async def leave(url: str, silent: threading.Event, call: str) -> None:
            task = asyncio.ensure_future(calls[call](AsyncClient(url)))
            await asyncio.get_running_loop().run_in_executor(None, silent.wait, 10)
            task.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await task

        for call, count in (("solve", 0), ("solve", 1), ("map", 0), ("map", 4), ("map", 9), ("batch", 0), ("batch", 1)):
            left, silent = threading.Event(), threading.Event()
            with self.subTest(call, count=count), HostileServer(self.answers(count, left, silent)) as server:
                with unittest.mock.patch("signorini.conversation.PATIENCE_TO_CANCEL", 0.1):
                    began = time.monotonic()
                    asyncio.run(leave(server.url, silent, call))
                    self.assertLess(time.monotonic() - began, 3)
                left.set()
                # What is known of is cancelled, as long as there are answers; the first that is missing ends it.
                self.assertEqual(len(server.requests), count + 2)


class Tls(unittest.TestCase):
    context: ssl.SSLContext
    certificate: str

    @classmethod
    def setUpClass(cls) -> None:
        with tempfile.TemporaryDirectory() as directory:
            key, certificate = pathlib.Path(directory) / "key", pathlib.Path(directory) / "certificate"
            names = ["-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"]
            kind = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-noenc"]
            command = ["openssl", "req", "-x509", *kind, "-keyout", str(key), "-out", str(certificate), *names]
            subprocess.run(command, check=True, capture_output=True)
            cls.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            cls.context.load_cert_chain(certificate, key)
            cls.certificate = certificate.read_text()

    def test_what_is_trusted_is_spoken_with(self) -> None:
        trusting = ssl.create_default_context(cadata=self.certificate)
        with HostileServer(lambda number, request: http_reply(b'{"model": "membrane"}'), tls=self.context) as server:
            for kind in (Client, AsyncClient):
                self.assertEqual(ask(kind, server.url, CALLS["example"], context=trusting), PROBLEM)

    def test_what_is_not_trusted_is_said_at_once(self) -> None:
        with HostileServer(lambda number, request: b"", tls=self.context) as server:
            self.expect_at_once(server.url, "no TLS with https://.*certificate verify failed: self-signed")
            self.assertEqual(server.requests, [])

    def test_the_wrong_protocol_is_said_at_once(self) -> None:
        with HostileServer(lambda number, request: http_reply(b"{}")) as server:
            self.expect_at_once(server.url.replace("http", "https"), "no TLS with https://.*does it speak http://")
        with HostileServer(lambda number, request: b"", tls=self.context) as server:
            self.expect_at_once(server.url.replace("https", "http"), "http://127.0.0.1")

    def expect_at_once(self, url: str, words: str) -> None:
        for kind in (Client, AsyncClient):
            for call in ("solve", "map", "example"):
                began = time.monotonic()
                with self.assertRaisesRegex(SignoriniError, words):
                    ask(kind, url, CALLS[call])
                self.assertLess(time.monotonic() - began, 2)


class Addresses(unittest.TestCase):
    def test_names_are_encoded(self) -> None:
        with HostileServer(lambda number, request: http_reply(json.dumps(GOOD).encode())) as server:
            for kind in (Client, AsyncClient):
                for name in ("a/b", "a?b#c", "a b", "a\r\nX: y", "ü", "../x", "%2e"):
                    server.requests.clear()
                    for call in named_calls(name):
                        ask(kind, server.url, call)
                    for request in server.requests:
                        line = request.split(b"\r\n")[0]
                        places = rb"(examples/[^/?#]+|solves/[^/?#]+/result\?[^/?#]+|solves\?[^/?#]+)"
                        self.assertRegex(line, rb"^GET /v1/" + places + rb" HTTP/1.1$")
                        self.assertNotIn(b"\nX:", request)

    def test_addresses_and_tokens_that_are_none_are_refused(self) -> None:
        for kind in (Client, AsyncClient):
            for url, words in (
                ("http://anne:secret@host", "no user and no password"), ("http://host?x=1", "no query"),
                ("http://host/#a", "no query"), ("http://host?", "no query"), ("http://host:0", "1 to 65535"),
                ("http://host:65536", "[Pp]ort"), ("http://host:x", "[Pp]ort"), ("http://ho st", "visible"),
                (" http://host", "visible"), ("http://host\r\nX: y", "visible"), ("http://hößt", "visible"),
                ("http://a..b", "is no address"), ("http://[::1", "is no address"), ("http://" + "a" * 99, "is no ad"),
            ):  # fmt: skip
                with self.subTest(url), self.assertRaisesRegex(ValueError, words) as caught:
                    kind(url)
                self.assertNotIn("secret", str(caught.exception))
            tokens: list[Any] = ["a\r\nX: y", "a b", "ü", "", "tok\x00en", "€", b"bytes", 3]
            for token in tokens:
                with self.subTest(token), self.assertRaisesRegex(ValueError, "a token is") as caught:
                    kind("http://host", token=token)
            with self.assertRaisesRegex(ValueError, "patience is"):
                kind("http://host", patience=-1)
            for url in ("http://host", "https://host:1/", "http://[::1]:8080", "http://host/signorini/"):
                kind(url, token="a-b_c.d~e+f/g=")


if __name__ == "__main__":
    unittest.main()
