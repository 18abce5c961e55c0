"""Holds what runs and watches a fleet against the program: what files under docker/ name is there.

    manifests_test.py SIGNORINID

- Variables that services are given are those of flags, and what they are set to is taken.
- On Kubernetes, selectors meet labels, secrets that are mounted are volumes, and probes ask for routes that there are.
- Alert rules pass promtool's check and their test, if there is a promtool.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import yaml

DOCKER = pathlib.Path(__file__).parents[2] / "docker"


def configured(environment):
    """The exit code and the output of --print-config under these variables."""
    known = {name: value for name, value in environment.items() if name != "SIGNORINI_CONFIG"}
    known["SIGNORINI_DATABASE"] = "postgresql://signorini@database/signorini"
    run = subprocess.run([PROGRAM, "--print-config"], env=known | {"PATH": os.environ["PATH"]}, capture_output=True, text=True)
    return run.returncode, run.stdout + run.stderr


def flags():
    text = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"Env:(SIGNORINI_[A-Z_]+)", text)) | {"SIGNORINI_CONFIG"}


class Compose(unittest.TestCase):
    def setUp(self):
        self.services = yaml.safe_load((DOCKER / "compose.fleet.yaml").read_text())

    def test_services_are_configured_by_what_there_is(self):
        environment = self.services["services"]["signorini"]["environment"]
        self.assertLessEqual(set(environment), flags())
        code, output = configured(environment)
        self.assertEqual(code, 0, output)
        self.assertIn("postgresql://signorini@database/signorini", output)

    def test_three_are_behind_the_proxy_and_secrets_are_files(self):
        service = self.services["services"]["signorini"]
        self.assertEqual(service["deploy"]["replicas"], 3)
        self.assertNotIn("ports", service)
        for each in self.services["services"].values():
            self.assertLessEqual(set(each.get("secrets", [])), set(self.services["secrets"]))
        self.assertIn("dynamic a signorini 8080", (DOCKER / "Caddyfile.fleet").read_text())


class Kubernetes(unittest.TestCase):
    def setUp(self):
        text = (DOCKER / "kubernetes" / "signorini.yaml").read_text()
        self.objects = list(yaml.safe_load_all(text))
        self.deployments = [each for each in self.objects if each["kind"] == "Deployment"]

    def labels(self):
        return [each["spec"]["template"]["metadata"]["labels"] for each in self.deployments]

    def test_kinds_and_names(self):
        kinds = [each["kind"] for each in self.objects]
        for kind in ("Service", "PodDisruptionBudget", "HorizontalPodAutoscaler", "NetworkPolicy"):
            self.assertIn(kind, kinds)
        names = [(each["kind"], each["metadata"]["name"]) for each in self.objects]
        self.assertEqual(len(names), len(set(names)))

    def test_selectors_meet_labels(self):
        for each in self.objects:
            spec = each["spec"]
            selector = spec.get("selector", spec.get("podSelector"))
            if selector is None:
                target = spec["scaleTargetRef"]["name"]
                self.assertIn(target, [one["metadata"]["name"] for one in self.deployments])
                continue
            wanted = selector.get("matchLabels", selector).items()
            self.assertTrue(any(wanted <= labels.items() for labels in self.labels()), each["metadata"]["name"])

    def test_pods_are_configured_by_what_there_is(self):
        for deployment in self.deployments:
            pod = deployment["spec"]["template"]["spec"]
            self.assertIs(pod["enableServiceLinks"], False)
            (container,) = pod["containers"]
            environment = {each["name"]: each["value"] for each in container["env"]}
            self.assertLessEqual(set(environment), flags())
            code, output = configured(environment)
            self.assertEqual(code, 0, output)
            self.assertIn(f'role="{deployment["metadata"]["labels"]["role"]}"', output)
            volumes = {each["name"] for each in pod["volumes"]}
            self.assertEqual({each["name"] for each in container["volumeMounts"]}, volumes)
            for path in (environment["SIGNORINI_CONFIG"], environment["SIGNORINI_TOKEN_FILE"]):
                self.assertIn(os.path.dirname(path), [each["mountPath"] for each in container["volumeMounts"]])
            self.assertEqual(container["readinessProbe"]["httpGet"]["path"], "/readyz")
            self.assertEqual(container["livenessProbe"]["httpGet"]["path"], "/healthz")
            self.assertGreater(pod["terminationGracePeriodSeconds"], 20)


class Monitoring(unittest.TestCase):
    def test_the_dashboard_asks_for_something_in_each_panel(self):
        board = json.loads((DOCKER / "monitoring" / "dashboard.json").read_text())
        identities = [panel["id"] for panel in board["panels"]]
        self.assertEqual(len(identities), len(set(identities)))
        for panel in board["panels"]:
            self.assertTrue(all(target["expr"] for target in panel["targets"]), panel["title"])

    @unittest.skipUnless(shutil.which("promtool"), "there is no promtool (Debian: prometheus)")
    def test_rules(self):
        for words in (["check", "rules", "alerts.yaml"], ["test", "rules", "alerts_test.yaml"]):
            run = subprocess.run(["promtool", *words], cwd=DOCKER / "monitoring", capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
