#!/usr/bin/env python3
"""`abbe live`: its server over HTTP, as a browser and as a stranger.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml live_test.py
"""
import http.client
import json
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from program_case import MACHINE, PROGRAM


class Server:
    def __init__(self, folder, *arguments, command=("live",)):
        self.process = subprocess.Popen([PROGRAM, *command, *([folder] if folder else []), *arguments],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.line = self.process.stderr.readline()
        url = re.search(r"live page: http://([\d.]+):(\d+)/(?:\?token=(\w+))?", self.line)
        self.host, self.port, self.token = url[1], int(url[2]), url[3]

    def get(self, path, host="127.0.0.1", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        connection.putrequest("GET", path, skip_host=True)
        connection.putheader("Host", f"{host}:{self.port}")
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        return connection.getresponse()

    def events(self, count, path="/events", **headers):
        """[(id, name, data)] of the first `count`, or to the end."""
        response, found, event = self.get(path, **headers), [], {}
        while len(found) < count and not (found and found[-1][1] == "end"):
            line = response.readline().decode().rstrip("\n")
            name, _, value = line.partition(": ")
            if name in ("id", "event", "data"):
                event[name] = value
            elif not line and event:
                found.append((event.get("id"), event["event"], json.loads(event["data"])))
                event = {}
        response.close()
        return found

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        _, said = self.process.communicate(timeout=20)
        return self.process.returncode, said


class LiveTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def serve(self, *arguments, folder=None):
        server = Server(folder or self.folder, *arguments)
        self.addCleanup(lambda: (server.process.kill(), server.process.communicate()))
        return server

    def write(self, name, **result):
        (self.folder / name).write_text(json.dumps({"command": "reduce", **result}))

    def test_the_page_and_its_headers(self):
        server = self.serve()
        response = server.get("/")
        page = response.read().decode()
        self.assertEqual(response.status, 200)
        policy = response.getheader("Content-Security-Policy")
        for part in ("default-src 'none'", "connect-src 'self'", "frame-ancestors 'none'", "base-uri 'none'"):
            self.assertIn(part, policy)
        scripts = re.search(r"script-src ([^;]*)", policy)[1]
        self.assertRegex(scripts, r"^('sha256-[\w+/=]+' ?)+$")
        self.assertEqual(response.getheader("X-Content-Type-Options"), "nosniff")
        self.assertNotIn("@@", re.sub(r"<script>.*?</script>|<style>.*?</style>", "", page, flags=re.S))
        self.assertIsNone(re.search(r"<(?:script|link|img)[^>]+(?:src|href)=[\"']?https?:", page))
        self.assertEqual(server.get("/../etc/passwd").status, 404)
        self.assertEqual(server.end()[0], 0)

    def test_a_browser_that_was_away_gets_what_it_missed(self):
        self.write("a.json", n=1)
        server = self.serve()
        first = server.events(3)
        self.assertEqual([name for _, name, _ in first], ["hello", "result", "state"])
        last = first[-1][0]
        self.write("b.json", n=2)
        self.write("c.json", n=3)
        missed = server.events(3, Last_Event_ID=last)
        self.assertEqual([name for _, name, _ in missed], ["hello", "result", "result"])
        self.assertEqual({data["result"]["n"] for _, name, data in missed if name == "result"}, {2, 3})
        # One that saw another server gets everything.
        self.assertEqual(len(server.events(5, Last_Event_ID="ffffffffffff-99")), 5)

    def test_strangers_are_refused(self):
        server = self.serve()
        self.assertEqual(server.get("/", host="evil.example").status, 403)
        self.assertEqual(server.get("/events", host="evil.example").status, 403)
        server = self.serve("--live-bind", "0.0.0.0")
        self.assertEqual(len(server.token), 32)
        self.assertEqual(server.get("/").status, 403)
        self.assertEqual(server.get("/events?token=" + "0" * 32).status, 403)
        self.assertEqual(server.get("/?token=" + server.token, host="mill.example").status, 200)
        self.assertEqual(server.events(1, "/events?token=" + server.token)[0][1], "hello")

    def test_twelve_browsers_at_most(self):
        server = self.serve()
        browsers = [server.get("/events") for _ in range(12)]
        self.assertEqual([browser.status for browser in browsers], [200] * 12)
        self.assertEqual(server.get("/events").status, 503)
        for browser in browsers:
            browser.close()
        for _ in range(100):  # the next sign of life finds them gone
            if server.get("/events").status == 200:
                return
            time.sleep(0.1)
        self.fail("the places of browsers that left stay taken")

    def test_what_goes_wrong_is_one_line(self):
        taken = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(taken.close)
        for arguments, code, saying in (
                (["live", self.folder, "--live-port", taken.getsockname()[1]], 3, "Address already in use"),
                (["live", self.folder, "--live-bind", "192.0.2.1"], 3, "--live-bind"),
                (["live", self.folder / "none"], 2, "is no folder")):
            run = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=30)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
            self.assertIn(saying, run.stderr)

    def test_a_recording_is_shown_whole(self):
        ready, machine, out = (self.folder / name for name in ("ready", "machine.toml", "run.csv"))
        rig = subprocess.Popen([PROGRAM, "rig", "--machine", MACHINE, "--port", "0", "--ready-file", ready],
                               stdout=subprocess.DEVNULL)
        self.addCleanup(lambda: (rig.kill(), rig.wait()))
        while not ready.exists() or not ready.read_text().endswith("\n"):
            time.sleep(0.02)
        machine.write_text(re.sub(r"(?m)^port = .*", f"port = {ready.read_text()}", pathlib.Path(MACHINE).read_text()))
        server = Server(None, machine, "--devices", "head,machine", "--seconds", "3", "-o", out, "--live", "--quiet",
                        command=("record",))
        self.addCleanup(lambda: (server.process.kill(), server.process.communicate()))
        events = server.events(10**6)
        recorded = sum(line[0].isdigit() for line in out.read_text().splitlines())
        self.assertGreater(recorded, 30)
        self.assertEqual(sum(data["n"] for _, name, data in events if name == "rows"), recorded)
        columns = next(data for _, name, data in events if name == "columns")
        self.assertIn("probe_a_um", columns)
        self.assertEqual(server.process.wait(timeout=20), 0)

    def test_the_folder_vanishes(self):
        folder = self.folder / "measured"
        folder.mkdir()
        server = self.serve(folder=folder)
        folder.rmdir()
        events = server.events(3)
        self.assertEqual(events[-1][1:], ("folder", {"there": False}))
        self.assertRegex(server.end()[1], r"^abbe: .*measured: has vanished .*\n$")


if __name__ == "__main__":
    unittest.main()
