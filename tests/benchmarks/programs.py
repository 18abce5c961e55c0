"""The programs that are measured: a process each, on one core, with its seconds and its peak memory."""

import json
import os
import re
import shutil
import statistics
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build/release"
FREEFEM = shutil.which("FreeFem++")


class Run:
    """What a process took: CPU seconds, which on an idle machine are those of the clock; its peak memory in MB, and
    what it wrote. It works in a folder of its own, for IPOPT leaves files behind."""

    def __init__(self, command, text="", environment=None):
        with (
            tempfile.TemporaryFile("w+") as given,
            tempfile.TemporaryFile("w+") as written,
            tempfile.TemporaryDirectory() as folder,
        ):
            given.write(text)
            given.seek(0)
            child = subprocess.Popen(
                command,
                stdin=given,
                stdout=written,
                stderr=subprocess.STDOUT,
                cwd=folder,
                env=os.environ | (environment or {}),
                preexec_fn=lambda: os.sched_setaffinity(0, {0}),
            )
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            self.cpu = usage.ru_utime + usage.ru_stime
            self.megabytes = usage.ru_maxrss / 1024
            written.seek(0)
            self.output = written.read()
        if child.returncode:
            raise RuntimeError(f"{command} ended with {child.returncode}:\n{self.output}")


class Runs:
    """The medians of some runs of the same command, and the output of the last."""

    def __init__(self):
        self.runs = []

    def add(self, run):
        self.runs.append(run)

    def __getattr__(self, name):
        return statistics.median(getattr(run, name) for run in self.runs)

    @property
    def output(self):
        return self.runs[-1].output

    @property
    def summary(self):
        return json.loads(self.output)["summary"]

    @property
    def energy(self):
        """Of FreeFEM's scripts, which print it, or of the summary."""
        printed = re.search(r"^energy (\S+)", self.output, re.MULTILINE)
        return float(printed[1]) if printed else self.summary["energy"]


def signorini(problem):
    command = [str(BUILD / "server/signorinid"), "--log-level", "error", "solve", "--fields", "summary", "-"]
    return Run(command, json.dumps(problem))


def freefem(script, n):
    """On Debian 12 the packaged load path names a folder that does not exist."""
    folder = Path(__file__).parent / "freefem"
    command = [FREEFEM, "-nw", "-v", "0", str(folder / script), str(n)]
    return Run(command, environment={"FF_LOADPATH": "/usr/lib/freefem++;./", "FF_INCLUDEPATH": str(folder)})


def google_benchmarks(pattern, turns):
    """The medians of the benchmarks in C++ whose names match: name -> figure -> value."""
    command = [
        str(BUILD / "tests/benchmarks/benchmarks"),
        f"--benchmark_filter={pattern}",
        "--benchmark_min_time=0.2",
        "--benchmark_format=json",
    ]
    one_thread = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    found = {}
    for _ in range(turns):
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=one_thread).stdout
        for each in json.loads(output)["benchmarks"]:
            figures = found.setdefault(each["name"].removesuffix("/real_time"), {})
            for figure, value in each.items():
                if isinstance(value, float):
                    figures.setdefault(figure, []).append(value)
    return {
        name: {figure: statistics.median(values) for figure, values in figures.items()}
        for name, figures in found.items()
    }
