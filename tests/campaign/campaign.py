"""Random problems and known ones, solved by the service in several ways and judged from outside.

    campaign.py                       the known cases and forty seeds, or 500 under SIGNORINI_LONG_TESTS
    campaign.py --seeds 0:300 --jobs 2 --daemon PATH
    campaign.py --only 15             one seed, or one known case by name
    campaign.py --show 15             its problem document
"""
import argparse
import collections
import json
import multiprocessing
import os
import pathlib
import re
import sys
import time
import traceback

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import checks  # noqa: E402 — numpy reads the variable when it is loaded
import generator  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
MOST_UNMET = 0.02


def known():
    return {path.stem: path for path in sorted((HERE / "known").glob("*.json"))}


def document_of(name):
    path = known().get(name)
    return json.loads(path.read_text(encoding="utf-8")) if path else generator.problem(int(name))


def judge(task):
    name, daemon = task
    began = time.monotonic()
    try:
        report = checks.check(name, document_of(name), daemon)
    except Exception:  # one problem that the judge stumbles over must not hide the others
        report = checks.Report(name)
        report.broken.append("the judge itself failed: " + traceback.format_exc().strip().replace("\n", " | "))
    report.seconds = time.monotonic() - began
    return report


def kind(text):
    """A reason without its places and numbers, to count it by."""
    return re.sub(r"-?\d+(\.\d+)?(e[-+]?\d+)?", "#", text)


def unmet_of_random(reports):
    """The runs of random problems that are not guaranteed, and their share; known cases may say that they are not."""
    random = [r for r in reports if r.name not in known()]
    unmet = len({(r.name, run) for r in random for run, _ in r.unmet})
    return unmet, unmet / max(1, sum(r.runs for r in random))


def table(reports):
    unmet, share = unmet_of_random(reports)
    yield (f"problems {len(reports)}, runs {sum(r.runs for r in reports)}, "
           f"guaranteed {sum(r.guaranteed for r in reports)}")
    for what, of in (("contradictions", lambda r: r.contradictions), ("broken promises", lambda r: r.broken)):
        yield f"{what} {sum(len(of(r)) for r in reports)} in {sum(bool(of(r)) for r in reports)} problems"
    yield f"unmet in {unmet} runs of random problems, {100 * share:.1f} %"
    for title, of in (("unmet", lambda r: r.unmet), ("failures", lambda r: r.failures)):
        counts = collections.Counter(kind(reason) for r in reports for _, reason in of(r))
        first = {kind(reason): r.name for r in reversed(reports) for _, reason in of(r)}
        for reason, count in counts.most_common():
            yield f"  {title} {count:4d}  {reason[:300]}  (as in {first[reason]})"
    for reason, count in collections.Counter(kind(n) for r in reports for n in r.notes).most_common():
        yield f"  note {count:4d}  {reason[:200]}"


def fails(reports):
    return any(r.contradictions or r.broken for r in reports) or unmet_of_random(reports)[1] > MOST_UNMET


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", help="A:B, from A to B − 1")
    parser.add_argument("--known", action="store_true", help="the cases of the folder known")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--daemon", default=str(HERE.parents[1] / "build/release/server/signorinid"))
    parser.add_argument("--only", help="one seed or known case")
    parser.add_argument("--show", help="write the problem document of a seed or known case, and end")
    options = parser.parse_args()
    if options.show is not None:
        print(json.dumps(document_of(options.show), indent=1))
        return 0
    names = [options.only] if options.only is not None else []
    if options.known:
        names += list(known())
    if options.seeds:
        first, last = map(int, options.seeds.split(":"))
        names += [str(seed) for seed in range(first, last)]
    if not names:
        seeds = 500 if "SIGNORINI_LONG_TESTS" in os.environ else 40
        names = list(known()) + [str(seed) for seed in range(seeds)]
    reports = []
    with multiprocessing.Pool(options.jobs) as pool:
        for report in pool.imap(judge, [(name, options.daemon) for name in names]):
            reports.append(report)
            for line in report.lines():
                print(line, flush=True)
    print("\n".join(table(reports)))
    print(f"seconds {sum(r.seconds for r in reports):.0f}")
    return 1 if fails(reports) else 0


if __name__ == "__main__":
    sys.exit(main())
