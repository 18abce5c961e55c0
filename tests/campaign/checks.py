"""What must hold between the service's answers to one problem, and between them and the independent program's."""
from dataclasses import dataclass, field

import primal
import service
import units

UNITS = 1e3, 1e-9, 1e9  # length, displacement, stiffness


@dataclass
class Report:
    name: str
    runs: int = 0
    guaranteed: int = 0
    contradictions: list = field(default_factory=list)
    broken: list = field(default_factory=list)  # promises of the pages
    unmet: list = field(default_factory=list)  # (run, reason)
    failures: list = field(default_factory=list)
    notes: list = field(default_factory=list)  # what could not be judged
    seconds: float = 0

    def lines(self):
        for kind, texts in (("CONTRADICTION", self.contradictions), ("BROKEN", self.broken), ("unmet", self.unmet),
                            ("failure", self.failures), ("note", self.notes)):
            for text in texts:
                yield f"{self.name}: {kind}: {text if isinstance(text, str) else ': '.join(text)}"


def check(name, document, daemon):
    report = Report(name)
    other = service.by_other_scheme(document)
    runs = [service.run(daemon, *run) for run in (
        (document["scheme"], document), (document["scheme"] + " refined", service.refined(document, 1)),
        (document["scheme"] + " refined twice", service.refined(document, 2)),
        (other["scheme"], other), (other["scheme"] + " refined", service.refined(other, 1)))]
    in_units = service.run(daemon, "other units", units.scaled(document, *UNITS))
    for run in runs + [in_units]:
        account(run, report)
    rungs = ladder(document, daemon, report)
    tiny = rungs.found.natural_energy() if rungs else 0
    compare_units(runs[0], in_units, tiny, report)
    claims = [run for run in runs if not run.failure() and run.guaranteed]
    compare_intervals(claims, tiny, report)
    if claims and rungs:
        compare_with_primal(claims, rungs, report)
    return report


def ladder(document, daemon, report):
    """The independent program's energies, or nothing if it finds no admissible displacement."""
    rungs = primal.Ladder(document, daemon)
    try:
        rungs.level(1)
    except primal.NotAdmissible as why:
        report.notes.append(f"no energy from outside: {why}")
        return None
    return rungs


def account(run, report):
    report.runs += 1
    status = run.result.get("status")
    expected = 0 if status == "succeeded" else 1 if isinstance(status, str) else 2
    if run.code not in (expected, None):
        report.broken.append(f"{run.name}: exit code {run.code}, {expected} documented")
    if run.failure():
        report.failures.append((run.name, run.failure()))
        return
    if run.guaranteed:
        report.guaranteed += 1
    elif run.bound.get("unmet"):
        report.unmet += [(run.name, reason) for reason in run.bound["unmet"]]
    else:
        report.broken.append(f"{run.name}: not guaranteed, and no reason in `unmet`")
    if run.guaranteed and run.interval[0] > run.interval[1] + rounding(run):
        report.contradictions.append(f"{run.name}: lower above upper, {run.interval}")
    if run.summary["outcome"] == "converged":
        limit = 1e-9 if run.summary["method"] == "active_set" else run.document.get("solver", {}).get("tolerance", 1e-8)
        for residual in ("penetration", "tension", "complementarity"):
            if run.summary["residuals"][residual] > limit:
                report.broken.append(f"{run.name}: {run.summary['method']} converged with the {residual} "
                                     f"{run.summary['residuals'][residual]:.2e} > {limit:g}")


def rounding(run, natural=0):
    """Of an energy: its terms may be larger than their sum, and a body that only moves has none."""
    stress = run.bound["value"] / run.bound["relative"] if run.bound.get("relative") else 0
    ends = run.interval if run.guaranteed else ()
    return 1e-9 * max(*map(abs, ends), abs(run.summary["energy"]), stress ** 2) + 1e-12 * natural


def compare_units(run, scaled, natural, report):
    def same(what, a, b):
        if a != b:
            report.broken.append(f"other units: {what} is {b}, was {a}")

    same("the exit code", run.code, scaled.code)
    if run.failure() or scaled.failure():
        same("whether it fails", bool(run.failure()), bool(scaled.failure()))
        return
    same("the outcome", run.summary["outcome"], scaled.summary["outcome"])
    same("guaranteed", run.guaranteed, scaled.guaranteed)
    factor = UNITS[2] * UNITS[1] ** 2
    off = abs(scaled.summary["energy"] / factor - run.summary["energy"])
    # An iteration stops where its tolerance lets it; where cells end before a load is resolved they may end elsewhere,
    # which the bound pays for.
    paid_for = 0.01 * (run.interval[1] - run.interval[0]) if run.guaranteed else 0
    if off > max(1e3 * rounding(run, natural), paid_for):
        report.broken.append(f"other units: the energy is {scaled.summary['energy'] / factor:.12g}, "
                             f"was {run.summary['energy']:.12g}")


def compare_intervals(claims, natural, report):
    for a in claims:
        for b in claims:
            if a.interval[0] > b.interval[1] + max(rounding(a, natural), rounding(b, natural)):
                report.contradictions.append(f"{a.name} {show(a)} and {b.name} {show(b)} are disjoint")


def show(run):
    return "[{:.9g}, {:.9g}]".format(*run.interval)


def compare_with_primal(claims, rungs, report):
    upper = min(energy + error for energy, error in (rungs.level(0), rungs.level(1)))
    for run in claims:
        if run.interval[0] > upper + rounding(run):
            report.contradictions.append(f"{run.name} {show(run)} lies above an admissible energy, {upper:.9g}")
    # How far the energy can still fall is no theorem: what is claimed to lie below is looked at on finer meshes.
    lowest = min(claims, key=lambda run: run.interval[1])
    try:
        for level in range(1, 4):
            if lowest.interval[1] >= rungs.likely_least(level) - rounding(lowest):
                return
    except primal.NotAdmissible as why:
        report.notes.append(f"no energy from outside on finer meshes: {why}")
        return
    report.contradictions.append(f"{lowest.name} {show(lowest)} lies below all that energies on finer meshes tend to, "
                                 f"{rungs.likely_least(3):.9g} … {rungs.level(3)[0]:.9g}")
