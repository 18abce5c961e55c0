"""`signorinid solve` at a terminal, which is a pty here. Run as: terminal_test.py PATH_OF_SIGNORINID"""

import csv
import io
import json
import os
import pathlib
import pty
import re
import subprocess
import sys
import threading
import unittest

EXAMPLES = pathlib.Path(__file__).parents[2] / "api/examples"


def read_all(descriptor):
    """What comes to a terminal until nobody writes to it any more."""
    heard = b""
    try:
        while piece := os.read(descriptor, 65536):
            heard += piece
    except OSError:  # EIO: all writers have gone
        pass
    return heard.decode()


def solve(*arguments, problem, terminals=("stdout", "stderr"), term="xterm", command="solve"):
    """The exit code, and what goes to standard output and to standard error."""
    streams, readers, heard = {}, [], {}
    for name in ("stdout", "stderr"):
        ours, theirs = pty.openpty() if name in terminals else os.pipe()
        streams[name] = theirs
        readers.append(threading.Thread(target=lambda name=name, ours=ours: heard.update({name: read_all(ours)})))
        readers[-1].start()
    process = subprocess.Popen([SIGNORINID, command, *arguments, "-"], stdin=subprocess.PIPE, **streams,
                               env={**os.environ, "TERM": term})
    for theirs in streams.values():
        os.close(theirs)
    process.communicate(json.dumps(problem).encode(), timeout=120)
    for reader in readers:
        reader.join()
    return process.returncode, heard["stdout"].replace("\r\n", "\n"), heard["stderr"].replace("\r\n", "\n")


def example(name):
    return json.loads((EXAMPLES / f"{name}.json").read_text())


class Terminal(unittest.TestCase):
    def test_a_table_is_read_there(self):
        code, table, shown = solve(problem=example("elastic-block"))
        self.assertEqual(code, 0, shown)
        self.assertEqual(table.splitlines()[0], example("elastic-block")["title"])
        self.assertRegex(table, r"\nconverged +3 iterations of active_set, 2048 triangles, ")
        self.assertRegex(table, r"\nerror bound +0\.00\d+, 0\.\d+ % of the stress, guaranteed\n")
        self.assertRegex(table, r"\n +energy between -0\.0266\d+ and -0\.0266\d+\n")
        self.assertRegex(table, r"\ncontact +force 2, largest pressure 1\.32\d+, closed length 1\.718\d+\n")
        self.assertRegex(table, r"\nbottom +\S+ +2 +\S+\n")
        self.assertNotIn("{", table)
        self.assertTrue(all(len(line) <= 100 for line in table.splitlines()), table)

    def test_what_is_piped_is_json(self):
        code, text, shown = solve(problem=example("elastic-block"), terminals=())
        self.assertEqual((code, shown), (0, ""))
        self.assertEqual(json.loads(text)["summary"]["outcome"], "converged")
        for arguments in (["--format", "json"], ["--fields", "summary"]):
            _, text, _ = solve(*arguments, problem=example("elastic-block"))
            self.assertEqual(json.loads(text)["summary"]["triangles"], 2048)
        _, table, _ = solve("--format", "table", problem=example("elastic-block"), terminals=())
        self.assertIn("error bound", table)

    def test_progress_is_shown_in_one_line_that_is_taken_away(self):
        slow = example("paper-nonconforming")
        slow["mesh"]["divisions"] = [64, 64]
        # For a time and not for a number of iterations, which a fast machine has done before a second line is due.
        slow["solver"] = {"rho": 1e-3, "augmentation": 1, "tolerance": 1e-12, "max_iterations": 100000, "time_limit": 1}
        _, _, shown = solve("--format", "json", problem=slow, terminals=("stderr",))
        lines = re.findall(r"\r\x1b\[K(\w+) +8192 triangles  iteration (\d+)  (\d+\.\d) s", shown)
        self.assertGreater(len(lines), 1, shown)
        self.assertIn("iterate", {phase for phase, _, _ in lines})
        numbers = [int(iteration) for _, iteration, _ in lines]
        self.assertEqual(numbers, sorted(numbers))
        # The failure is told behind it, on a line of its own.
        last = shown.rsplit("\r\x1b[K", 1)[1]
        self.assertRegex(last, r"^Not all was done in time: the time limit .*\n$")
        for quiet in ({"terminals": ("stdout",)}, {"term": "dumb"}):
            self.assertNotIn("\x1b", solve(problem=slow, **quiet)[2])

    def test_faults_are_read_there_and_documents_elsewhere(self):
        bad = example("elastic-block")
        bad["mesh"], bad["boundary"]["\x1b[31m"] = {"divisions": [0, 4]}, {"type": "fixed"}
        code, _, told = solve(problem=bad)
        self.assertEqual(code, 2)
        self.assertNotIn("{", told)
        self.assertNotIn("\x1b", told)
        self.assertRegex(told, r"\n  /mesh/divisions\S* \S")
        _, _, document = solve(problem=bad, terminals=("stdout",))
        self.assertIn("/mesh/divisions", {fault["pointer"][:15] for fault in json.loads(document)["errors"]})

    def test_each_level_stays_in_a_line(self):
        code, table, shown = solve(problem=example("adaptive-mesh"))
        self.assertEqual(code, 0)
        levels = re.findall(r"level (\d+) +(\d+) triangles  bound (\S+) +(\S+) %", shown)
        self.assertGreater(len(levels), 2, shown)
        self.assertEqual([int(number) for number, *_ in levels], list(range(1, len(levels) + 1)))
        told = re.findall(r"^(\d+) +(\d+) +\d+ +(\S+) +(\S+) % +\S+$", table, re.MULTILINE)
        self.assertEqual(told, levels)

    def test_entries_of_a_sweep_are_a_table(self):
        sweep = example("gap-sweep")
        sweep["title"] = "from \x1b[31m elsewhere\n"
        _, table, _ = solve(problem=sweep)
        self.assertNotIn("\x1b", table)
        self.assertTrue(table.startswith("from  [31m elsewhere"))
        for number in range(len(sweep["sweep"])):
            self.assertRegex(table, rf"\n{number}\b.* \S+ +\S+ +\S+ +\S+ +\S+")
        self.assertEqual(re.findall(r"^(\d) .* \S+ %", table, re.MULTILINE), ["0", "3"])

    def test_tables_for_spreadsheets(self):
        problem = example("elastic-block")
        for field, columns in {"contact": "part,x,y,clearance,pressure,gap,open", "history": "iteration,"}.items():
            code, text, _ = solve("--format", "csv", "--field", field, problem=problem, terminals=())
            self.assertEqual(code, 0)
            self.assertTrue(text.startswith(columns), text[:80])
            self.assertGreater(len(list(csv.reader(io.StringIO(text)))), 3)
        _, contact, _ = solve("--format", "csv", problem=problem, terminals=())
        self.assertTrue(contact.startswith("part,"))
        for wrong in (["--field", "stress"], ["--deformed", "2"], ["--fields", "mesh"]):
            code, _, told = solve("--format", "csv", *wrong, problem=problem, terminals=())
            self.assertEqual((code, json.loads(told)["title"]), (2, "Bad flag"))


if __name__ == "__main__":
    SIGNORINID = sys.argv.pop(1)
    unittest.main()
