"""The command line in place of a service: programs that are none, and what becomes of those that run."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from typing import Any

import cbor2

from daemon import PROGRAM, block
from signorini import BadReply, Local, Refused, ServiceUnreachable, SolveFailed

#: A problem that takes longer than the tests.
LONG = block(divisions=(300, 150))


class Programs(unittest.TestCase):
    directory: tempfile.TemporaryDirectory[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.directory = tempfile.TemporaryDirectory(prefix="with spaces ")

    @classmethod
    def tearDownClass(cls) -> None:
        cls.directory.cleanup()

    def program(self, script: str) -> pathlib.Path:
        """A program of Bash in a directory with spaces in its name."""
        path = pathlib.Path(self.directory.name) / f"a program {time.monotonic_ns()}"
        path.write_text(f"#!/bin/bash\n{script}\n")
        path.chmod(0o755)
        return path

    def test_a_path_may_have_spaces(self) -> None:
        path = self.program(f'exec {PROGRAM} "$@"')
        self.assertEqual(Local(path).solve(block()).status, "succeeded")
        self.assertEqual(Local(str(path)).map([block()])[0].status, "succeeded")

    def test_what_is_no_program_cannot_be_run(self) -> None:
        text = self.program("")
        text.chmod(0o644)
        paths: list[str | pathlib.Path] = ["no-such-program", self.directory.name, text, "a\0b", ""]
        for path in paths:
            with self.subTest(path), self.assertRaisesRegex(ServiceUnreachable, "cannot be run"):
                Local(path).solve(block())
            with self.assertRaisesRegex(ServiceUnreachable, "cannot be run"):
                Local(path).map([block()] * 3)

    def test_another_program_is_said_to_be_one(self) -> None:
        for script, words in (
            ("true", "it writes nothing"), ("echo hello", "it writes b'hello"), ("cat", "it writes b'{"),
            ("head -c 1000 /dev/urandom", "it writes b"),
            ("head -c 100000 /dev/zero | tr '\\0' '\\237'", "nested too dee"),
            (r"printf '\xa0'", "it is no result"), (r"printf '\x83\x01\x02\x03'", "it is no result"),
        ):  # fmt: skip
            path = self.program(script)
            with self.subTest(script):
                with self.assertRaisesRegex(BadReply, "is no signorinid, or none for this client: .*" + words):
                    Local(path).solve(block())
                with self.assertRaises(BadReply):
                    Local(path).map([block()] * 3)

    def test_what_a_program_says_is_said(self) -> None:
        for script, error, words in (
            ("echo broken >&2; exit 1", SolveFailed, "broken"), ("exit 127", SolveFailed, "failed"),
            ("echo '[1]' >&2; exit 2", Refused, r"\[1\]"),
            ("printf '\\xff' >&2; exit 2", Refused, "The program failed"),
            ("kill -SEGV $$", SolveFailed, "was ended by SIGSEGV"),
            ("echo half; kill -KILL $$", SolveFailed, "SIGKILL"),
        ):  # fmt: skip
            with self.subTest(script), self.assertRaisesRegex(error, words):
                Local(self.program(script)).solve(block())

    def test_a_program_that_reads_nothing_is_read(self) -> None:
        document = cbor2.dumps({"status": "succeeded", "summary": {}})
        path = self.program(f"exec 0<&-; printf '{''.join(f'{chr(92)}x{byte:02x}' for byte in document)}'")
        big = {"model": "membrane", "title": "x" * 1_000_000}
        self.assertEqual(Local(path).solve(big).status, "succeeded")


class Interruptions(unittest.TestCase):
    def expect_end(self, call: str, program: str) -> None:
        """Who gets SIGINT alone, as from the stop button of a notebook, ends soon, and his programs with him."""
        code = (
            "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "import sys; from local_test import LONG; from signorini import Local\n"
            "local = Local(sys.argv[1], workers=2)\n"
            "local.solve(LONG) if sys.argv[2] == 'solve' else local.map([LONG] * 10)"
        )
        command = [sys.executable, "-c", code, program, call]
        with subprocess.Popen(command, cwd=pathlib.Path(__file__).parent, stderr=subprocess.PIPE, text=True) as child:
            while not (programs := children(child.pid)) and child.poll() is None:
                time.sleep(0.05)
            time.sleep(0.2)
            child.send_signal(signal.SIGINT)
            began = time.monotonic()
            self.assertIn("KeyboardInterrupt", child.communicate(timeout=20)[1])
            self.assertLess(time.monotonic() - began, 5)
        self.assertTrue(programs)
        self.assertEqual([pid for pid in programs if pathlib.Path(f"/proc/{pid}").exists()], [])

    def test_ctrl_c_ends_the_programs(self) -> None:
        for call in ("solve", "map"):
            self.expect_end(call, PROGRAM)

    def test_ctrl_c_ends_programs_that_do_not_hear_it(self) -> None:
        with tempfile.TemporaryDirectory() as directory:
            deaf = pathlib.Path(directory) / "deaf"
            deaf.write_text("#!/bin/bash\ntrap '' INT TERM\nexec sleep 100\n")
            deaf.chmod(0o755)
            for call in ("solve", "map"):
                self.expect_end(call, str(deaf))

    def test_an_error_of_the_progress_ends_all(self) -> None:
        began = time.monotonic()

        def fail(done: int, count: int) -> None:
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            Local(PROGRAM, workers=2).map([block(), LONG, LONG, LONG], progress=fail)
        self.assertLess(time.monotonic() - began, 5)
        self.assertEqual(children(os.getpid()), [])
        self.assertEqual(threading.active_count(), 1)


def children(pid: int) -> list[int]:
    """The processes that this one has started and that have not ended."""
    tasks = pathlib.Path(f"/proc/{pid}/task")
    found: list[Any] = []
    for task in tasks.iterdir() if tasks.exists() else ():
        found += (task / "children").read_text().split()
    return [int(each) for each in found]


if __name__ == "__main__":
    unittest.main()
