"""A service that a test starts and ends."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import threading

from signorini import Contact, MeshRequest, Problem, Rectangle, Roller, Solver, Traction, YoungPoisson

PROGRAM = os.environ["SIGNORINID"]
#: The paper's iteration, ended long before it is done.
STOPPED_EARLY = Solver(method="uzawa", rho=0.001, augmentation=0.01, max_iterations=2)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


class Daemon:
    """`signorinid` on a port of its own, which it keeps when it is started again; `log` has what it said."""

    def __init__(self, *flags: str, data_dir: str = ":memory:") -> None:
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.flags = [*flags, "--data-dir", data_dir]
        self.log: list[str] = []
        self.process: subprocess.Popen[str]
        self.reader: threading.Thread
        self.start()

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.returncode is None:
            self.end(signal.SIGKILL)

    def start(self) -> None:
        """Returns when it listens."""
        self.process = subprocess.Popen(
            [PROGRAM, "--port", str(self.port), *self.flags], stderr=subprocess.PIPE, text=True
        )
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self.log.append(line)
            if "listening on " in line:
                break
        else:
            raise RuntimeError("the service did not start: " + "".join(self.log))
        self.reader = threading.Thread(target=self.log.extend, args=[self.process.stderr], daemon=True)
        self.reader.start()

    def end(self, by: signal.Signals) -> None:
        self.process.send_signal(by)
        self.process.wait(timeout=30)
        self.reader.join()
        assert self.process.stderr is not None
        self.process.stderr.close()


def block(young: float = 200.0, divisions: tuple[int, int] = (8, 4), title: str | None = None) -> Problem:
    """An elastic block that a pressure presses on a curved foundation."""
    return Problem(
        title=title,
        model="elasticity",
        domain=Rectangle((0, 0), (2, 1)),
        mesh=MeshRequest(divisions=divisions),
        material=YoungPoisson(young, 0.3),
        boundary={"left": Roller(), "bottom": Contact("0.01 * x^2"), "top": Traction(pressure=1)},
        scheme="conforming",
        solver=Solver(method="active_set"),
    )
