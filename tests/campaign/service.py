"""The service's answer to a problem document."""
import copy
import json
import os
import subprocess
from dataclasses import dataclass

LONGEST = 900  # seconds; a solve takes far below one, but the machine may be busy


@dataclass
class Run:
    name: str
    document: dict
    code: int | None  # none if it had to be ended
    result: dict

    @property
    def summary(self):
        return self.result.get("summary") or {}

    @property
    def bound(self):
        return self.summary.get("error_bound") or {}

    @property
    def guaranteed(self):
        return bool(self.bound.get("guaranteed"))

    @property
    def interval(self):
        return self.bound["energy_lower"], self.bound["energy_upper"]

    def failure(self):
        """Why there is no result to trust, or nothing."""
        if self.result.get("status") == "succeeded":
            return None
        if "errors" in self.result:
            return "refused: " + "; ".join(f"{e['pointer']} {e['detail']}" for e in self.result["errors"])
        if "status" not in self.result:
            return f"no answer, exit code {self.code}"
        return f"{self.result['status']}: {self.result.get('error', '')}"


def run(daemon, name, document):
    try:
        done = subprocess.run([daemon, "solve", "--fields", "summary,contact", "-"], input=json.dumps(document),
                              text=True, capture_output=True, timeout=LONGEST,
                              env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return Run(name, document, None, {"status": f"no end within {LONGEST} s"})
    try:
        result = json.loads(done.stdout)
    except ValueError:
        result = {}
    return Run(name, document, done.returncode, result)


def refined(document, times):
    out = copy.deepcopy(document)
    mesh = out.setdefault("mesh", {})
    mesh["refine"] = mesh.get("refine", 0) + times
    return out


def by_other_scheme(document):
    out = copy.deepcopy(document)
    out["scheme"] = "conforming" if document["scheme"] == "nonconforming" else "nonconforming"
    return out
