"""Measures and writes the report; tests/benchmarks/run says how."""

import math
import sys

from problems import PAPER_ENERGY, elastic_block, gap_sweep, paper
from programs import BUILD, FREEFEM, Runs, freefem, google_benchmarks, signorini
from report import Report

QUICK = "--quick" in sys.argv[1:]
LARGEST = 256 if QUICK else 1024
TURNS = 1 if QUICK else 5


def up_to(largest, first=128):
    n = first
    while n <= min(largest, LARGEST):
        yield n
        n *= 2


def side_by_side(n, problem, scripts):
    """The runs of ours, and of the fastest of FreeFEM's scripts, in turns; once where one takes minutes."""
    ours, theirs = Runs(), {script: Runs() for script in scripts if FREEFEM}
    for turn in range(TURNS):
        ours.add(signorini(problem))
        if n <= 256 or turn == 0:
            for script, runs in theirs.items():
                runs.add(freefem(script, n))
    return ours, min(theirs.values(), key=lambda runs: runs.cpu, default=None)


def ratio(ours, theirs):
    return f"1/{theirs / ours:.1f}" if theirs > ours else f"{ours / theirs:.2f}"


def exponent(points):
    """Of the last value in the first, from the first point to the last."""
    (x0, y0), (x1, y1) = points[0], points[-1]
    return math.log(y1 / y0) / math.log(x1 / x0)


def processes(report):
    """Returns FreeFEM's seconds for P1 at the finest mesh."""
    kinds = [
        ("paper", paper, LARGEST, ["membrane_p1.edp", "membrane_ipopt.edp"]),
        ("elastic block", elastic_block, 256, ["elastic_block.edp"]),
    ]
    rows, seconds, slowest = [], {}, None
    for name, problem, largest, scripts in kinds:
        for n in up_to(largest):
            ours, theirs = side_by_side(n, problem(n), scripts)
            row = [name, n, f"{ours.cpu:.3f}", f"{ours.megabytes:.0f}"]
            seconds.setdefault(f"Signorini, {name}", []).append((2 * n * n, ours.cpu))
            if theirs:
                row += [f"{theirs.cpu:.2f}", f"{theirs.megabytes:.0f}", ratio(ours.cpu, theirs.cpu)]
                seconds.setdefault(f"FreeFEM P1, {name}", []).append((2 * n * n, theirs.cpu))
                slowest = theirs.cpu if name == "paper" else slowest
            rows.append(row)
    report.table(
        "The whole process on one core",
        "CPU seconds of `signorinid solve --fields summary`, `nonconforming`, `active_set`, the guaranteed bound "
        "included, beside P1 elements in FreeFEM on the same mesh (primal-dual active set or IPOPT, whichever is "
        "faster).",
        ["problem", "N", "seconds", "MB", "FreeFEM s", "FreeFEM MB", "ratio"],
        rows,
    )
    growth = exponent(seconds["Signorini, paper"])
    report.sentence(f"On the paper's problem they grow as the number of triangles to the power {growth:.2f}.")
    report.plot(seconds)
    return slowest


def accuracy(report, p1_seconds):
    asked = 5e-6
    runs = {"Signorini, conforming": lambda n: signorini(paper(n, "conforming"))}
    if FREEFEM:
        runs["FreeFEM, P2"] = lambda n: freefem("membrane_p2.edp", n)
    rows = []
    for name, run in runs.items():
        coarsest = None
        for n in (128, 64, 32, 16, 8):  # an error may be small by chance: all finer meshes must agree
            measured = Runs()
            for _ in range(TURNS):
                measured.add(run(n))
            error = abs(measured.energy / PAPER_ENERGY - 1)
            if error > asked:
                break
            coarsest = [name, n, f"{error:.1e}", f"{measured.cpu:.3f}"]
            coarsest.append(ratio(measured.cpu, p1_seconds) if p1_seconds and not QUICK else "")
        rows.append(coarsest)
    report.table(
        "Accuracy",
        f"The coarsest of the meshes N = 8, 16, 32, … from which on the energy of the paper's problem is true "
        f"to {asked:.0e}; P1 elements need N = 1024 for it. The last column compares with their time above.",
        ["", "N", "relative error", "seconds", "against P1"],
        rows,
    )


def factorisation(report):
    sizes = "|".join(str(n) for n in up_to(1024))
    measured = google_benchmarks(f"(factor|whole_solve)/.*/({sizes})$", TURNS)
    rows, solves = [], []
    for name, whole in measured.items():
        what, problem, n = name.rsplit("/", 2)
        if what != "whole_solve":
            continue
        ways = [measured[f"factor/{way}_{problem}/{n}"] for way in ("multifrontal", "cholmod_given", "cholmod_own")]
        head = [problem.replace("_", " "), n, f"{ways[0]['unknowns']:.0f}"]
        rows.append(head)
        for figure, digits in (("cpu_time", 0), ("megabytes", 0), ("peak_megabytes", 0), ("gigaflops", 2)):
            head.append(" / ".join(f"{way[figure]:.{digits}f}" for way in ways))
        cholmod = min(way["cpu_time"] for way in ways[1:])
        solve = whole["cpu_time"] * (1 - whole["certificate_part"])
        row = [f"{milliseconds:.0f}" for milliseconds in (cholmod, solve, whole["cpu_time"])]
        solves.append([*head[:2], *row, f"{solve / cholmod:.2f}", f"{whole['cpu_time'] / cholmod:.2f}"])
    report.table(
        "Two factorisations",
        "Ours / CHOLMOD's in our order / CHOLMOD's in its own order with the contact unknowns last: the same hybrid "
        "matrix from its elements to the contact complement and one solution. CPU milliseconds, megabytes of the "
        "factor and at the peak, and thousand millions of products and sums.",
        ["problem", "N", "unknowns", "milliseconds", "MB", "MB at the peak", "Gflop"],
        rows,
    )
    report.table(
        "Contact costs nothing",
        "CPU milliseconds of the better of CHOLMOD's factorisations, and of the whole solve (mesh, elements, our "
        "factor, contact, fields, residuals), without and with the guaranteed bound.",
        ["problem", "N", "CHOLMOD", "solve", "with bound", "solve/CHOLMOD", "with bound"],
        solves,
    )


def uzawa(report):
    kinds = [
        ("paper, nonconforming", lambda n, method: paper(n, "nonconforming", method), 512),
        ("paper, conforming", lambda n, method: paper(n, "conforming", method), 256),
        ("elastic block", elastic_block, 256),
    ]
    rows = []
    for name, problem, largest in kinds:
        counts, times = [], None
        for n in up_to(largest, first=16):
            ours, exact = Runs(), Runs()
            for _ in range(TURNS):
                ours.add(signorini(problem(n, "uzawa")))
                exact.add(signorini(problem(n, "active_set")))
            counts.append((n, ours.summary["iterations"]))
            times = ours.cpu / exact.cpu
        listed = ", ".join(str(count) for _, count in counts)
        rows.append([name, listed, f"{exponent(counts):.2f}", f"{times:.2f}"])
    report.table(
        "Uzawa, auto",
        "Iterations to 1e-8 for N = 16, 32, …, their growth as a power of N, and the time of the whole process "
        "beside `active_set` on the finest of these meshes.",
        ["problem", "iterations", "exponent", "against active_set"],
        rows,
    )


def sweep(report):
    measured = Runs()
    measured.add(signorini(gap_sweep(105, 1000)))
    unknowns, triangles = measured.summary["unknowns"]["stress"], measured.summary["triangles"]
    report.table(
        "A sweep",
        "One job with 1000 gaps on the elastic block, the whole process.",
        ["stress unknowns", "triangles", "seconds", "MB"],
        [[unknowns, triangles, f"{measured.cpu:.1f}", f"{measured.megabytes:.0f}"]],
    )


def service(report):
    http, wire = google_benchmarks("Http", TURNS), google_benchmarks("WriteField/", TURNS)
    quick = http["HttpLatency/active_set"]["median_ms"]
    paper_form = http["HttpLatency/uzawa_200_iterations"]["median_ms"]
    rate, rate_64, rate_on_disk = (http["HttpThroughput/active_set" + case]["solves_per_second"]
                                   for case in ("", "_64_clients", "_64_clients_on_disk"))
    json, cbor = (wire[f"WriteField/{form}"]["bytes_per_second"] / 1e6 for form in ("json", "cbor"))
    report.table(
        "The service",
        "The paper's problem with N = 12 through HTTP (keep-alive, `?wait=`, summary; clients and two workers "
        "share the cores), and the writers on one core.",
        ["", ""],
        [
            ["`active_set`, one client, median", f"{quick:.1f} ms"],
            ["`uzawa`, 200 iterations of the paper's form", f"{paper_form:.1f} ms"],
            ["`active_set`, eight clients", f"{rate:.0f} solves a second"],
            ["`active_set`, 64 clients, in memory and on the disk",
             f"{rate_64:.0f} and {rate_on_disk:.0f} solves a second"],
            ["a field of 15 million numbers as JSON", f"{json:.0f} MB/s"],
            ["the same as CBOR", f"{cbor:.0f} MB/s"],
        ],
    )


def main():
    report = Report(BUILD / "benchmarks")
    p1_seconds = processes(report)
    accuracy(report, p1_seconds)
    factorisation(report)
    uzawa(report)
    sweep(report)
    service(report)
    report.sentence(
        "Not covered: other packages than FreeFEM, more than one core a solve, meshes that are not "
        "uniform, a network, TLS, a store on disk."
        + ("" if FREEFEM else " FreeFEM was not to be had: its columns are empty.")
    )
    report.close()


main()
