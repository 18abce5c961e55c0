"""Talks with a service and holds every reply, and every problem, against its OpenAPI document.

With --prism, the path of @stoplight/prism-cli, the conversation goes through its validating proxy too.
"""

import argparse
import contextlib
import http.client
import json
import pathlib
import re
import socket
import subprocess
import sys
import threading
import time
import unittest
import urllib.parse

from jsonschema import Draft202012Validator

JSON = "application/json"


def strict(schema):
    """The schema, which no longer lets members pass that it does not name."""
    if isinstance(schema, list):
        return [strict(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    made = {key: value if key in ("examples", "example", "default") else strict(value) for key, value in schema.items()}
    if "properties" in made and "type" in made and "additionalProperties" not in made:
        made["additionalProperties"] = False
    return made


def listening_url(process, pattern):
    """Where a process says that it listens; what else it says is read and dropped."""
    for line in process.stderr:
        if found := re.search(pattern, line):
            threading.Thread(target=process.stderr.read, daemon=True).start()
            return found.group(1)
    raise RuntimeError("it ended before it listened")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def prism_before(service):
    """Prism's proxy before the service, and where it listens."""
    process = subprocess.Popen(
        [options.prism, "proxy", service + "/openapi.json", service, "--port", str(free_port())],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    process.stderr = process.stdout
    return process, listening_url(process, r"listening on (http\S+)")


def passes_unchanged(body, expected):
    """Prism reads a body and writes it anew: only an object that is sound JSON comes out as it was."""
    return body is None or (expected != 400 and body.strip()[:1] in ("{", b"{"))


class Conversation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = subprocess.Popen(
            [options.signorinid, "--port", "0", "--data-dir", ":memory:"], stderr=subprocess.PIPE, text=True)
        cls.processes = [cls.daemon]
        cls.service = cls.base = listening_url(cls.daemon, r"listening on (http\S+)")
        text = cls.exchange(cls.service, "GET", "/openapi.json")[2]
        if options.save:
            pathlib.Path(options.save).write_bytes(text)
        cls.document = json.loads(text)
        cls.strict = strict(cls.document)
        if options.prism:
            proxy, cls.base = prism_before(cls.service)
            cls.processes.append(proxy)

    @classmethod
    def tearDownClass(cls):
        for process in reversed(cls.processes):
            process.terminate()
            process.wait()

    @staticmethod
    def exchange(base, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection(urllib.parse.urlsplit(base).netloc, timeout=120)
        with contextlib.closing(connection):
            connection.request(method, path, body, headers or {})
            reply = connection.getresponse()
            return reply.status, reply.headers, reply.read()

    def validate(self, schema, value):
        return list(Draft202012Validator({**schema, "components": self.strict["components"]}).iter_errors(value))

    def resolve(self, node):
        while "$ref" in node:
            name = node["$ref"]
            node = self.strict
            for key in name[2:].split("/"):
                node = node[key]
        return node

    def operation(self, method, path):
        """A path without parameters comes before one that has some."""
        path = path.split("?")[0]
        for pattern in sorted(self.strict["paths"], key=lambda each: each.count("{")):
            if re.fullmatch(re.sub(r"{\w+}", "[^/]+", pattern), path):
                return self.strict["paths"][pattern].get(method.lower())
        self.fail(f"{path} is not in the document")

    def check_proxy(self, status, headers):
        """What prism complains about: a reply never may differ from the document, a request if it is refused."""
        for violation in json.loads(headers.get("sl-violations", "[]")):
            of_request = violation["location"][0] == "request"
            self.assertTrue(of_request and status >= 400, violation)

    def call(self, method, path, expected, body=None, **headers):
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        if body is not None:
            headers.setdefault("Content-Type", JSON)
        base = self.base if passes_unchanged(body, expected) else self.service
        status, reply_headers, reply = self.exchange(base, method, path, body, headers)
        with self.subTest(method=method, path=path):
            self.assertEqual(status, expected, reply[:500])
            self.check_proxy(status, reply_headers)
            operation = self.operation(method, path)
            if operation is None:
                self.assertEqual(status, 405)
                return json.loads(reply)
            responses = operation["responses"]
            response = self.resolve(responses.get(str(status), responses["default"]))
            for name in response.get("headers", {}):
                if name in ("X-Request-Id", "Location", "Content-Disposition", "Retry-After"):
                    self.assertIn(name, reply_headers)
            if "content" not in response:
                self.assertEqual(reply, b"")
                return None
            media_type = reply_headers["Content-Type"].split(";")[0]
            self.assertIn(media_type, response["content"])
            if "json" not in media_type or media_type.endswith("ndjson"):
                return reply
            value = json.loads(reply)
            errors = self.validate(response["content"][media_type]["schema"], value)
            self.assertEqual([f"{error.json_path}: {error.message[:300]}" for error in errors], [])
            return value

    def examples(self):
        body = self.document["components"]["requestBodies"]["Problem"]
        return {name: example["value"] for name, example in body["content"][JSON]["examples"].items()}

    def problem(self, **members):
        return json.dumps({**self.examples()["paper-nonconforming"], **members})

    def solved(self, body, query=""):
        return self.call("POST", "/v1/solves?wait=100" + query, 200, body)["id"]

    def test_every_member_says_what_it_is(self):
        def walk(where, schema):
            if "$ref" in schema and "description" not in schema:
                schema = {**schema, **self.resolve(schema)}
            self.assertIn("description", schema, where)
            tells = any(key in schema for key in ("examples", "enum", "const", "properties", "oneOf", "$ref"))
            self.assertTrue(tells or schema.get("type") == "boolean", f"{where} has neither an example nor values")
            for name, member in schema.get("properties", {}).items():
                if member:
                    walk(f"{where}.{name}", member)

        for name, schema in self.document["components"]["schemas"].items():
            walk(name, schema)

    def test_every_example_is_solved(self):
        names = [each["name"] for each in self.call("GET", "/v1/examples", 200)["examples"]]
        self.assertEqual(names, list(self.examples()))
        for name, example in self.examples().items():
            self.assertEqual(self.call("GET", f"/v1/examples/{name}", 200), example)
            self.call("POST", "/v1/validate", 200, json.dumps(example))
            self.solved(json.dumps(example))
        self.call("GET", "/v1/examples/none", 404)

    def test_the_document_takes_what_the_service_takes(self):
        schema = {"$ref": "#/components/schemas/Problem"}
        with open(options.bad_bodies) as file:
            bodies = json.load(file)
        for each in bodies:
            with self.subTest(each["name"]):
                expected = each["status"]
                self.call("POST", "/v1/validate", expected, each["body"].encode())
        self.assertEqual(self.validate(schema, self.examples()["paper-conforming"]), [])
        for member in ["model", "domain", "material", "boundary", "scheme"]:
            broken = self.examples()["paper-conforming"]
            del broken[member]
            self.assertNotEqual(self.validate(schema, broken), [], member)

    def test_a_solve_from_its_beginning_to_its_end(self):
        # Hours, if it were not cancelled.
        slow = self.problem(mesh={"divisions": [300, 300]},
                            solver={"rho": 1e-9, "augmentation": 0, "tolerance": 1e-15, "max_iterations": 1000000})
        solve = self.call("POST", "/v1/solves", 202, slow, Idempotency_Key="a-key")
        path = solve["links"]["self"]
        self.assertEqual(self.call("POST", "/v1/solves", 202, slow, Idempotency_Key="a-key")["id"], solve["id"])
        self.call("POST", "/v1/solves", 422, self.problem(), Idempotency_Key="a-key")
        self.call("POST", "/v1/solves", 400, slow, Idempotency_Key="ä")
        self.call("GET", path + "/result", 409)
        self.call("GET", path + "/result.vtu", 409)
        while self.call("GET", path, 200)["progress"]["iteration"] < 2:
            time.sleep(0.05)
        self.call("GET", path + "/history", 200)
        self.call("GET", path + "/events", 400, Last_Event_ID="7")
        self.call("GET", "/v1/solves?status=running", 200)
        self.call("DELETE", path, 202)
        while self.call("GET", path, 200)["status"] == "running":
            time.sleep(0.05)
        self.call("GET", path + "/result", 410)
        self.call("DELETE", path, 204)
        self.call("GET", path, 404)
        self.call("DELETE", path, 404)

    def test_solves_by_tag_and_title(self):
        for number in range(3):
            self.solved(self.problem(tags=["study & seals", str(number)], title=f"seal {number}"), "&fields=summary")
        query = "/v1/solves?" + urllib.parse.urlencode({"tag": "study & seals"})
        for path in [query, query + "&limit=1", "/v1/solves?title=seal&limit=2"]:
            found = self.call("GET", path, 200)["solves"]
            self.assertEqual(found[0]["tags"], ["study & seals", "2"])
        self.call("DELETE", "/v1/solves", 400)
        count = self.call("DELETE", query, 409)["count"]
        self.assertEqual(self.call("DELETE", f"{query}&confirm={count}", 200), {"cancelled": 0, "deleted": 3})

    def test_batches(self):
        problems = [self.examples()["paper-nonconforming"], self.examples()["elastic-block"]]
        body = json.dumps({"title": "two", "tags": ["of a batch"], "problems": problems})
        batch = self.call("POST", "/v1/batches", 202, body, Idempotency_Key="a-batch")
        self.assertEqual(self.call("POST", "/v1/batches", 202, body, Idempotency_Key="a-batch"), batch)
        path = batch["links"]["self"]
        lines = self.call("GET", path + "/results?fields=summary,contact", 200).decode().splitlines()
        self.assertEqual({json.loads(line)["id"] for line in lines}, set(batch["solves"]))
        for line in lines:
            errors = self.validate({"$ref": "#/components/schemas/Result"}, json.loads(line))
            self.assertEqual([error.message for error in errors], [])
        self.call("GET", path + "/results", 200, Accept="application/cbor-seq")
        self.call("GET", path + "/results", 406, Accept="text/html")
        self.call("GET", path + "/results?fields=all", 400)
        self.assertEqual(self.call("GET", path, 200)["counts"]["succeeded"], 2)
        self.assertEqual(len(self.call("GET", "/v1/solves?tag=of%20a%20batch", 200)["solves"]), 2)
        self.call("POST", "/v1/batches", 422, json.dumps({"problems": [*problems, {}]}))
        too_large = {**problems[0], "mesh": {"divisions": [3100, 3100]}, "scheme": "conforming"}
        self.call("POST", "/v1/batches", 413, json.dumps({"problems": [too_large]}))
        self.call("POST", "/v1/batches", 400, "[")
        self.call("DELETE", path, 200)
        self.call("GET", path, 404)
        self.call("GET", path + "/results", 404)
        self.call("DELETE", path, 404)

    def test_results_in_every_form(self):
        for name in ["paper-conforming", "elastic-block", "gap-sweep", "adaptive-mesh"]:
            elastic = "elastic" in name
            fields = "&fields=summary,stress" + (",principal,von_mises" if elastic else "")
            path = "/v1/solves/" + self.solved(json.dumps(self.examples()[name]), fields)
            self.call("GET", path, 200)
            self.call("GET", path + "/result", 200)
            self.call("GET", path + "/result?fields=summary,contact,sweep", 200)
            self.call("GET", path + "/result", 200, Accept="application/cbor")
            self.call("GET", path + "/result.vtu", 200)
            self.call("GET", path + "/contact.csv", 200)
            self.call("GET", path + "/history.csv", 200)
            self.call("GET", path + "/quantities.csv", 200)
            self.call("GET", path + "/history", 200)
            events = self.call("GET", path + "/events", 200).decode()
            self.assertEqual(events.count("event: succeeded"), 1)
            last = re.findall("^id: (.*)$", events, re.MULTILINE)[-1]
            self.call("GET", path + "/events", 204, Last_Event_ID=last)
        self.call("GET", path + "/result?fields=everything", 400)
        self.call("GET", path + "/result", 406, Accept="text/html")

    def test_studies(self):
        study = self.examples()["convergence-study"]
        path = "/v1/solves/" + self.call("POST", "/v1/studies?wait=100&fields=study", 200, json.dumps(study))["id"]
        self.call("GET", path + "/study.csv", 200)
        adaptive = {**study, "study": {"adaptive": {"tolerance": 0.1}}}
        self.call("POST", "/v1/studies?wait=100&fields=study", 200, json.dumps(adaptive))
        adaptive["study"]["adaptive"] = {"tolerance": 1e-4, "max_triangles": 300}
        status = self.call("POST", "/v1/studies?wait=100&fields=study", 200, json.dumps(adaptive))["status"]
        self.assertEqual(status, "failed")
        self.call("POST", "/v1/studies", 202, json.dumps(study))
        self.call("POST", "/v1/studies", 422, self.problem())
        self.call("GET", "/v1/solves/" + self.solved(self.problem()) + "/study.csv", 404)

    def test_solves_that_fail(self):
        self.solved(self.problem(solver={"rho": 0.1, "augmentation": 1, "max_iterations": 3}))
        without_support = json.loads(self.problem(boundary={"bottom": {"type": "contact"}}, load={"body": 1}))
        del without_support["solver"]
        status = self.call("POST", "/v1/solves?wait=100", 200, json.dumps(without_support))
        self.assertEqual(status["status"], "failed")
        self.call("GET", "/v1/solves?limit=2", 200)

    def test_refusals(self):
        self.call("POST", "/v1/solves", 400, "{")
        self.call("POST", "/v1/solves", 415, self.problem(), Content_Type="text/plain")
        self.call("POST", "/v1/solves?wait=never", 400, self.problem())
        self.call("POST", "/v1/validate", 413, self.problem(mesh={"divisions": [3100, 3100]}, scheme="conforming"))
        self.call("GET", "/v1/solves?limit=0", 400)
        self.call("GET", "/v1/solves/none", 404)
        self.call("PUT", "/v1/solves", 405, self.problem())

    def test_pages_and_probes(self):
        for path in ["/", "/docs", "/pages/page.css", "/pages/shell.js", "/v1/examples/gap-sweep/picture.svg", "/openapi.json", "/healthz", "/readyz", "/metrics"]:
            self.call("GET", path, 200)
        self.call("GET", "/pages/none", 404)
        for path in ["/v1/solves", "/v1/solves/00000000000000000000000000", "/v1/examples/gap-sweep"]:
            self.call("GET", path, 200, Accept="text/html,*/*;q=0.8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("signorinid", help="path of the service")
    parser.add_argument("bad_bodies", help="tests/problems/bad_bodies.json")
    parser.add_argument("--prism", help="path of the proxy")
    parser.add_argument("--save", help="file that the document is written to")
    options = parser.parse_args()
    unittest.main(argv=sys.argv[:1])
