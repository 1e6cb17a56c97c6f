#!/usr/bin/env python3
"""`abbe history` as a user runs it: on results made by hand with known rates, on recordings of the virtual rig, with
stores that are locked, full, foreign or killed.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml history_test.py
"""
import csv
import datetime
import io
import json
import os
import pathlib
import random
import resource
import signal
import sqlite3
import subprocess
import time
import unittest

import numpy
from scipy import optimize, stats

from program_case import MACHINE, PROGRAM, ProgramCase

START = datetime.datetime.now(datetime.timezone.utc).replace(microsecond=0) - datetime.timedelta(days=100)
HOSTILE = "mill'; drop table figure; -- <script>alert(1)</script>"


def instant(days):
    return (START + datetime.timedelta(days=days)).strftime("%Y-%m-%dT%H:%M:%SZ")


def day_of(text):
    at = datetime.datetime.strptime(text, "%Y-%m-%dT%H:%M:%SZ").replace(tzinfo=datetime.timezone.utc)
    return (at - START).total_seconds() / 86400


def circle(days, value, u, machine="mill", feed=300.0):
    """The result of a circular test with this G(b)."""
    run = {"feed_mm_min": feed, "G_b_um": value, "u": {"G_b_um": u}, "u_calibration": {"G_b_um": 0.0}}
    return {"command": "circle", "machine": machine, "started": instant(days),
            "circles": [{"instrument": "linkage", "plane": "XY", "radius_mm": 20.0, "runs": [run]}]}


def sweep(days, straightness, u=0.1e-6, machine="mill"):
    """The result of a sweep of X with this straightness EYX."""
    return {"command": "reduce", "kind": "sweep", "machine": machine, "axis": "X", "started": instant(days),
            "stations": [0.0, 0.01, 0.02],
            "errors": {"EYX": {"unit": "m", "value": [0.0, straightness, 0.0], "u": [u] * 3}},
            "straightness": {"EYX": {"end_points": straightness, "least_squares": straightness,
                                     "minimum_zone": straightness, "u": u}},
            "budget": {"EYX": {"noise": 0.6 * u, "gain": 0.8 * u}}}


def machine_file(limits="", name="mill"):
    return (f'name = "{name}"\nchain = "[w X Y b Z t]"\naxis.X.positive = "tool"\naxis.Y.positive = "tool"\n' +
            "".join(f"axis.{a}.travel_mm = [0, 20]\n" for a in "XYZ") + limits)


class HistoryCase(ProgramCase):
    command = "history"

    def setUp(self):
        super().setUp()
        self.store = self.path / "history.db"

    def folder(self, name, *results):
        folder = self.path / name
        folder.mkdir(exist_ok=True)
        for i, result in enumerate(results):
            (folder / f"result_{i}.json").write_text(json.dumps(result))
        return folder

    def history(self, sub, *arguments):
        return self.done(*arguments, "--store", self.store, command=f"history {sub}")

    def data(self, sub, *arguments):
        self.history(sub, *arguments, "--json", self.path / "data.json", "--quiet")
        return json.loads((self.path / "data.json").read_text())

    def refused(self, sub, *arguments, code=2, saying=()):
        run = self.run_program(*arguments, "--store", self.store, command=f"history {sub}")
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        for text in saying:
            self.assertIn(text, run.stderr)


class Kept(HistoryCase):
    def test_a_campaign_is_kept_as_it_was_and_once(self):
        folder = self.folder("measured", sweep(0, 2e-6), circle(0, 4.0, 0.2))
        said = self.history("add", folder, "--note", "after service", "--operator", "A. Smith",
                            "--instrument", "head=P-12")
        self.assertIn("campaign 1: mill", said)
        self.assertIn("is in the history as campaign 1; nothing was added", self.history("add", folder))
        campaign = self.data("show", 1)
        self.assertEqual(campaign["note"], "after service")
        self.assertEqual(campaign["operator"], "A. Smith")
        self.assertEqual(campaign["instruments"], {"head": "P-12"})
        self.assertEqual(campaign["results"][0]["result"], sweep(0, 2e-6))
        figures = {each["name"]: each for result in campaign["results"] for each in result["figures"]}
        self.assertAlmostEqual(figures["EYX.straightness_um"]["value"], 2.0)
        self.assertAlmostEqual(figures["EYX.straightness_um"]["shares"]["head"], 0.64)
        self.assertEqual(figures["XY.circularity_um"]["value"], 4.0)
        # A folder that has grown adds what is new.
        self.folder("measured", sweep(0, 2e-6), circle(0, 4.0, 0.2), circle(0, 9.0, 0.2, feed=2000.0))
        self.assertIn("2 of its results are in campaign 1 already and were left out", self.history("add", folder))
        self.assertEqual([each["results"] for each in self.data("list")["campaigns"]], [2, 1])
        self.assertIn("forgotten", self.history("forget", 2))
        self.assertEqual(len(self.data("list")["campaigns"]), 1)

    def test_recordings_of_the_rig_are_known_by_path_and_content(self):
        folder = self.path / "measured"
        folder.mkdir()
        self.rig_record("measured/sweep_X.csv", "--axis", "X", "--mounting", "A", "--rate", 20)
        self.done(folder / "sweep_X.csv", "--machine", MACHINE, "--out", folder, "--quiet", command="reduce")
        (folder / "notes.csv").write_text("a,b\n1,2\n")
        self.history("add", folder, "--machine", MACHINE)
        campaign = self.data("show", "latest")
        self.assertEqual(campaign["machine"], "demo-mill")
        self.assertEqual(campaign["instruments"]["mounting"], "A")
        self.assertEqual(campaign["machine_file"]["content"], pathlib.Path(MACHINE).read_text())
        (recording,) = campaign["recordings"]
        sha = subprocess.run(["sha256sum", folder / "sweep_X.csv"], capture_output=True, text=True).stdout.split()[0]
        self.assertEqual((recording["path"], recording["sha256"]), (str(folder / "sweep_X.csv"), sha))
        names = {each["name"] for each in campaign["results"][0]["figures"]}
        self.assertLessEqual({"EYX.straightness_um", "EZX.reversal_um", "EAX.range_urad"}, names)
        self.assertEqual({each["object"] for each in campaign["results"][0]["curves"]},
                         {"EAX", "EBX", "ECX", "EYX", "EZX"})

    def test_a_time_has_a_zone_and_exists(self):
        self.history("add", self.folder("zone", {**sweep(0, 2e-6), "started": "2026-11-21T01:30:00+05:00"}))
        self.history("add", self.folder("said", {**sweep(0, 3e-6), "started": ""}), "--measured",
                     "2026-11-20T15:30:00-05:00")
        self.assertEqual([each["measured"] for each in self.data("list")["campaigns"]],
                         ["2026-11-20T20:30:00Z", "2026-11-20T20:30:00Z"])
        for time in ("2026-02-30T09:00:00Z", "2026-11-21T09:00:60Z", "2026-11-21T09:00:00 CET"):
            never = self.folder("never", {**sweep(0, 4e-6), "started": time})
            self.refused("add", never, saying=["result_0.json", time, "is no time"])
            self.refused("add", self.path / "said", "--measured", time, saying=["--measured", "is no instant"])

    def test_names_are_data(self):
        self.history("add", self.folder("x", sweep(0, 2e-6, machine=HOSTILE)), "--note", HOSTILE)
        (campaign,) = self.data("list", "--machine", HOSTILE)["campaigns"]
        self.assertEqual((campaign["machine"], campaign["note"]), (HOSTILE, HOSTILE))
        self.assertEqual(len(self.data("trend", "EYX", "--machine", HOSTILE)["series"]), 3)

    def test_export(self):
        note = '=1+1, "quoted"'
        self.history("add", self.folder("x", circle(0, 4.0, 0.2, machine=note)), "--note", note)
        rows = list(csv.DictReader(io.StringIO(self.history("export", "--format", "csv"))))
        self.assertEqual(rows[0]["machine"], "'" + note)  # no formula for a spreadsheet
        self.assertEqual((rows[0]["figure"], float(rows[0]["value"]), float(rows[0]["u"])), ("XY.circularity_um", 4.0, 0.2))
        everything = json.loads(self.history("export", "--format", "json"))
        self.assertEqual(everything["campaigns"][0]["results"][0]["result"], circle(0, 4.0, 0.2, machine=note))

    def test_the_default_store_is_that_of_the_user_and_said(self):
        home = self.path / "data"
        run = subprocess.run([PROGRAM, "history", "add", self.folder("x", circle(0, 4.0, 0.2))], capture_output=True,
                             text=True, env={**os.environ, "XDG_DATA_HOME": str(home)})
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn(f"store: {home}/abbe/history.db", run.stdout)
        self.assertTrue((home / "abbe/history.db").exists())

    def test_a_truncated_recording_is_called_so(self):
        whole = self.rig_record("sweep_X.h5", "--axis", "X", "--rate", 20)
        cut = self.path / "cut.h5"
        cut.write_bytes(whole.read_bytes()[:20000])
        self.refused("add", cut, "--machine", MACHINE, saying=["cut.h5", "truncated", "use an intact copy"])
        folder = self.folder("measured")
        for path in (whole, cut):
            path.rename(folder / path.name)
        run = self.run_program(folder, "--machine", MACHINE, "--store", self.store, command="history add")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("left out: " + str(folder / "cut.h5"), run.stderr)
        self.assertIn("1 recordings", run.stdout)

    def test_bad_campaigns_have_one_clear_line(self):
        self.refused("add", self.folder("two", sweep(0, 1e-6), sweep(0, 1e-6, machine="lathe")),
                     saying=["others are of", "add them one by one"])
        nameless = sweep(0, 1e-6)
        del nameless["machine"]
        self.refused("add", self.folder("nameless", nameless), saying=["names its machine; add --machine FILE"])
        undated = sweep(0, 1e-6)
        del undated["started"]
        self.refused("add", self.folder("undated", undated), saying=["says when it was measured", "--measured"])
        self.history("add", self.path / "undated", "--measured", instant(1))
        self.refused("add", self.folder("empty"), saying=["no result, recording or error map"])
        self.refused("add", self.path / "none", saying=["there is no such file or folder"])
        self.refused("add", self.path / "undated", "--instrument", "P-12", saying=["is not ROLE=NAME"])
        self.refused("add", self.path / "undated", "--measured", "yesterday", saying=["is no instant"])
        self.refused("show", "abc", saying=["is no campaign"])
        self.refused("show", 7, saying=["campaign 7: is not in", "the last one is 1"])
        self.refused("trend", "EYZ", saying=["no campaign of this machine has such a figure; did you mean EYX?"])
        self.refused("list", "--machine", "mil", saying=['did you mean "mill"?'])

    def test_a_clock_in_the_future_is_said(self):
        for i, days in enumerate((0, 10, 20, 4000)):
            run = self.run_program(self.folder(f"c{i}", circle(days, 4.0 + i, 0.1)), "--store", self.store,
                                   command="history add")
            self.assertEqual("in the future by the clock of this computer" in run.stderr, days == 4000, run.stderr)
        self.history("add", self.folder("late", circle(5, 4.5, 0.1)))
        said = self.history("trend", "XY.circularity_um")
        self.assertIn("1 of its campaigns is dated in the future", said)
        self.assertIn("was added after campaign", said)


class Judged(HistoryCase):
    def test_trend_agrees_with_scipy(self):
        """Paule and Mandel by NumPy and SciPy, on days that are uneven and uncertainties that differ."""
        draw = numpy.random.default_rng(5)
        days = numpy.sort(draw.uniform(0, 90, 15))
        u = draw.uniform(0.05, 0.4, 15)
        y = 4 + 0.02 * days + draw.normal(0, numpy.hypot(u, 0.3))
        for i, (day, value, one) in enumerate(zip(days, y, u)):
            self.folder(f"c{i}", circle(float(numpy.round(day * 86400) / 86400), float(value), float(one)))
        days = numpy.round(days * 86400) / 86400
        self.history("add", *(self.path / f"c{i}" for i in range(15)), "--machine", self.limits("circularity_um = 9.0"))
        (series,) = [each for each in self.data("trend", "XY")["series"] if each["quantity"] == "circularity_um"]
        x = numpy.column_stack([numpy.ones(15), days])

        def fit(tau2):
            w = 1 / (u**2 + tau2)
            cov = numpy.linalg.inv(x.T @ (w[:, None] * x))
            beta = cov @ (x.T @ (w * y))
            return beta, cov, float(w @ (y - x @ beta) ** 2)

        tau2 = optimize.brentq(lambda t: fit(t)[2] - 13, 0, 10, xtol=1e-15)
        beta, cov, _ = fit(tau2)
        # A scatter that goes on from one campaign to the next.
        weight = 1 / (u**2 + tau2)
        left = (y - x @ beta) * weight**0.5
        memory = numpy.clip((15 * (left[1:] @ left[:-1]) / (left @ left) + 3) / 11, 0, 0.95)
        share = numpy.mean(tau2 * weight)
        cov = cov * (1 + share * (2 * memory / (1 - memory)))
        self.assertAlmostEqual(series["fit"]["memory"], memory, places=6)
        k = stats.t.ppf(0.975, 13)
        self.assertAlmostEqual(series["fit"]["excess_scatter"], tau2**0.5, places=7)
        self.assertAlmostEqual(series["fit"]["rate_per_day"], beta[1], places=9)
        self.assertAlmostEqual(series["fit"]["U95_rate_per_day"], k * cov[1, 1] ** 0.5, places=9)
        band = lambda t: k * (numpy.array([1, t]) @ cov @ numpy.array([1, t])) ** 0.5
        line = series["line"]
        for text, value, U95 in zip(line["measured"], line["value"], line["U95"]):
            self.assertAlmostEqual(value, beta[0] + beta[1] * day_of(text), places=5)
            self.assertAlmostEqual(U95, band(day_of(text)), places=5)
        # The limit of 9 um: where line and band meet it.
        self.assertEqual(series["limit"], 9.0)
        reached = series["limit_reached"]
        self.assertAlmostEqual(day_of(reached["expected"]), (9 - beta[0]) / beta[1], places=4)
        edge = lambda sign: optimize.brentq(lambda t: beta[0] + beta[1] * t + sign * band(t) - 9, 50, 5000)
        self.assertAlmostEqual(day_of(reached["earliest"]), edge(1), places=3)
        self.assertAlmostEqual(day_of(reached["latest"]), edge(-1), places=3)

    def limits(self, text):
        path = self.path / "limits.toml"
        path.write_text(machine_file(f"\n[limits]\n{text}\n"))
        return path

    def test_a_line_beyond_the_limit_is_no_measurement_beyond_it(self):
        for i in range(6):
            self.folder(f"d{i}", circle(10.0 * i, 2.0 + 0.3 * i, 0.05))
        self.history("add", *(self.path / f"d{i}" for i in range(6)), "--machine", self.limits("circularity_um = 3.8"))
        said = self.history("trend", "XY.circularity_um")
        self.assertRegex(said, r"expected to be beyond its limit of 3\.8 um since \d{4}-\d\d-\d\d if the drift went on; "
                               r"last measured 3\.50 um on \d{4}-\d\d-\d\d")
        self.assertNotIn("it is beyond", said)
        self.history("add", self.folder("d6", circle(60.0, 3.9, 0.05)), "--machine", self.limits("circularity_um = 3.8"))
        self.assertIn("it is beyond its limit of 3.8 um", self.history("trend", "XY.circularity_um"))

    def test_a_known_rate_comes_out(self):
        for i in range(6):
            self.folder(f"c{i}", circle(10 * i, 3.0 + 0.5 * i, 0.05))
        self.history("add", *(self.path / f"c{i}" for i in range(6)))
        said = self.history("trend", "XY.circularity_um")
        self.assertIn("it changes by 1.50 +-", said)  # 0.5 um in 10 days

    def test_compare_says_what_changed(self):
        self.history("add", self.folder("a", sweep(0, 2e-6), circle(0, 4.0, 0.2)))
        self.history("add", self.folder("b", sweep(1, 3e-6), circle(1, 4.1, 0.2)))
        said = self.history("compare", 1, 2)
        self.assertIn("EYX straightness grew by 1.00 +- 0.28 um, from 2.00 to 3.00 um", said)
        data = self.data("compare", 1, 2)
        changed = {each["quantity"]: each for each in data["differences"]}
        self.assertTrue(changed["straightness_um"]["significant"])
        self.assertFalse(changed["circularity_um"]["significant"])
        self.assertAlmostEqual(changed["straightness_um"]["U95"], 2 * 2**0.5 * 0.1)
        self.assertEqual(changed["curve_um"]["at_mm"], 10.0)
        # A chance that underflows is not printed as 0.
        self.history("add", self.folder("c", circle(2, 4000.0, 0.2)))
        self.assertRegex(self.history("compare", 1, 3), r"circularity.* < 1e-300 ")

    def test_check_has_three_verdicts(self):
        folder = self.folder("a", sweep(0, 2e-6), circle(0, 4.0, 0.2))
        check = lambda *arguments: self.run_program(folder, "--machine", *arguments, "--json", self.path / "check.json",
                                                    "--force", command="history check")
        run = check(self.limits("EYX = { straightness_um = 3.0 }\ncircularity_um = 5"))
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        run = check(self.limits("EYX = { straightness_um = 1.5 }\ncircularity_um = 5"))
        self.assertEqual(run.returncode, 1)
        self.assertIn("1 of 2 figures fail", run.stderr)
        undecided = self.limits("EYX = { straightness_um = 2.1 }\nvolumetric_um = 20")
        run = check(undecided)
        self.assertEqual(run.returncode, 0)
        self.assertIn("1 of 2 figures are undecided", run.stderr)
        self.assertEqual(check(undecided, "--proven").returncode, 1)
        data = json.loads((self.path / "check.json").read_text())
        self.assertEqual({each["quantity"]: each["verdict"] for each in data["checks"]},
                         {"straightness_um": "undecided", "volumetric_um": "not measured"})
        # The same of the history.
        self.history("add", folder)
        run = self.run_program(1, "--machine", self.limits("EYX = { straightness_um = 1.5 }"), "--store", self.store,
                               command="history check")
        self.assertEqual(run.returncode, 1, run.stderr)

    def test_a_sweep_that_leaves_stations_out_proves_nothing(self):
        machine = self.limits("EYX = { straightness_um = 3.0 }\n")
        wide = self.write("wide.toml", machine.read_text().replace("[0, 20]", "[0, 100]"))
        cut = {**sweep(0, 2e-6), "planned": {"stations": 5, "passes": 2, "missing_stations": 2, "missing_passes": 1}}
        for name, result, file, reason in (
                ("cut", cut, machine, "2 of 5 planned stations are missing"),
                ("short", sweep(0, 2e-6), wide, "the stations, 0 to 20 mm, leave out part of the travel, 0 to 100 mm")):
            folder = self.folder(name, result)
            self.history("add", folder)
            for of in (folder, "latest"):
                run = self.run_program(of, "--machine", file, "--proven", "--store", self.store, "--json",
                                       self.path / "check.json", "--force", command="history check")
                self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
                (check,) = json.loads((self.path / "check.json").read_text())["checks"]
                self.assertEqual((check["verdict"], check["reason"]), ("undecided", reason))
                self.assertIn("undecided: " + reason, run.stdout)
        # What fails by the stations that are there fails.
        low = self.write("low.toml", machine.read_text().replace("= 3.0", "= 1.0"))
        run = self.run_program(self.path / "cut", "--machine", low, command="history check")
        self.assertIn("1 of 1 figures fail", run.stderr)

    def test_limits_for_what_does_not_exist_are_refused_everywhere(self):
        folder = self.folder("a", sweep(0, 2e-6))
        wrong = self.limits("EYW = { straightness_um = 3.0 }")
        for sub in ("add", "check"):
            self.refused(sub, folder, "--machine", wrong, saying=['there is no such error, axis or plane; did you mean "EYX"?'])
        self.refused("check", folder, "--machine", self.write("no.toml", machine_file()), saying=["has no [limits]"])
        self.refused("check", folder, "--machine", self.write("other.toml", machine_file("[limits]\nvolumetric_um = 3\n", "lathe")),
                     saying=["lathe"])

    def write(self, name, text):
        (self.path / name).write_text(text)
        return self.path / name


class Stores(HistoryCase):
    def many(self, count, prefix="c"):
        return [self.folder(f"{prefix}{i}", sweep(i / 10, 2e-6 + 1e-9 * i), circle(i / 10, 4.0 + 0.01 * i, 0.2)) for i in range(count)]

    def rows(self, statement):
        connection = sqlite3.connect(self.store)
        try:
            return connection.execute(statement).fetchall()
        finally:
            connection.close()

    def check_whole(self):
        self.assertEqual(self.rows("pragma integrity_check"), [("ok",)])
        # Each campaign has both results with their 3 figures and 1 and its curve, or is not there.
        self.assertEqual(set(self.rows("select c.id, (select count(*) from result r where r.campaign_id = c.id), "
                                       "(select count(*) from figure f join result r on f.result_id = r.id where r.campaign_id = c.id), "
                                       "(select count(*) from curve v join result r on v.result_id = r.id where r.campaign_id = c.id) "
                                       "from campaign c")),
                         {(id, 2, 4, 1) for (id,) in self.rows("select id from campaign")})

    def test_a_kill_loses_nothing_that_was_said(self):
        folders = self.many(40)
        draw, killed = random.Random(7), 0
        for _ in range(15):
            for suffix in ("", "-wal", "-shm"):
                pathlib.Path(f"{self.store}{suffix}").unlink(missing_ok=True)
            with subprocess.Popen([PROGRAM, "history", "add", *folders, "--store", self.store], stdout=subprocess.PIPE,
                                  text=True) as run:
                said = draw.randrange(1, 35)
                for _ in range(said):
                    run.stdout.readline()
                time.sleep(draw.uniform(0.0, 0.02))
                run.send_signal(signal.SIGKILL)
                said += run.stdout.read().count("\n")
            killed += run.returncode == -signal.SIGKILL
            self.check_whole()
            stored = self.rows("select count(*) from campaign")[0][0]
            self.assertGreaterEqual(stored, said)
            self.assertLessEqual(stored, said + 1)
        self.assertGreater(killed, 8)
        # What a kill leaves goes on.
        self.history("add", *folders)
        self.assertEqual(self.rows("select count(*) from campaign"), [(40,)])
        self.check_whole()

    def test_two_writers_at_once(self):
        one, two, both = self.many(15, "a"), [], self.many(5, "s")
        two = [self.folder(f"b{i}", sweep(i, 5e-6 + 1e-9 * i), circle(i, 8.0 + 0.01 * i, 0.2)) for i in range(15)]
        for folder in both:  # the same measurements for both
            result = json.loads((folder / "result_0.json").read_text())
            (folder / "result_0.json").write_text(json.dumps({**result, "started": instant(50)}))
            result = json.loads((folder / "result_1.json").read_text())
            (folder / "result_1.json").write_text(json.dumps({**result, "started": instant(50)}))
        runs = [subprocess.Popen([PROGRAM, "history", "add", *mine, *both, "--store", self.store], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True) for mine in (one, two)]
        for run in runs:
            _, errors = run.communicate(timeout=120)
            self.assertEqual((run.returncode, errors), (0, ""))
        self.assertEqual(self.rows("select count(*) from campaign"), [(35,)])
        self.check_whole()

    def test_a_full_disk_is_said_and_keeps_what_is_in(self):
        folders = self.many(200)
        self.history("add", folders[0])
        size = self.store.stat().st_size + 100_000
        run = subprocess.run([PROGRAM, "history", "add", *folders, "--store", self.store], capture_output=True, text=True,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        self.assertIn("the disk is full or fails", run.stderr)
        self.assertIn("nothing of this step was stored", run.stderr)
        said = run.stdout.count("campaign ") - run.stdout.count("as campaign")
        self.assertEqual(self.rows("select count(*) from campaign"), [(said + 1,)])
        self.check_whole()
        self.history("add", *folders)
        self.assertEqual(self.rows("select count(*) from campaign"), [(200,)])

    def test_stores_that_are_none(self):
        folder = self.folder("a", circle(0, 4.0, 0.2))
        self.refused("list", saying=["there is no history yet"])
        self.store.write_text("not a database, a letter")
        self.refused("add", folder, saying=["is not a history of abbe (no SQLite database)"])
        self.assertEqual(self.store.read_text(), "not a database, a letter")
        self.store.unlink()
        connection = sqlite3.connect(self.store)
        connection.execute("create table songs (id integer)")
        connection.commit()
        connection.close()
        self.refused("add", folder, saying=['it has the table "songs" of something else'])
        self.store.unlink()
        self.history("add", folder)
        connection = sqlite3.connect(self.store)
        connection.execute("update abbe_history set version = 99")
        connection.commit()
        connection.close()
        self.refused("list", saying=["is of version 99, this abbe knows"])
        run = self.run_program("--store", "mysql://host/db", command="history list")
        self.assertEqual(run.returncode, 2)
        self.assertIn("no such kind of store", run.stderr)
        run = self.run_program("--store", "postgresql://abbe:secret@127.0.0.1:1/db", command="history list")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("the server does not answer", run.stderr)
        self.assertNotIn("secret", run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)

    def test_a_locked_store_is_waited_for(self):
        first, second = self.many(2)
        self.history("add", first)
        holder = sqlite3.connect(self.store, isolation_level=None)
        holder.execute("begin immediate")
        run = subprocess.Popen([PROGRAM, "history", "add", second, "--store", self.store], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        self.assertIsNone(run.poll())
        holder.execute("commit")
        _, errors = run.communicate(timeout=60)
        self.assertEqual((run.returncode, errors), (0, ""))
        holder.close()


class Server(HistoryCase):
    """The same on a PostgreSQL server that goes away and comes back while campaigns are added."""

    SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "history/postgresql_server"

    def setUp(self):
        super().setUp()
        self.path.chmod(0o755)
        self.server_folder = self.path / "server"
        run = subprocess.run([self.SCRIPT, "start", self.server_folder], capture_output=True, text=True)
        if run.returncode == 77:
            self.skipTest("PostgreSQL is not installed")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.addCleanup(subprocess.run, [self.SCRIPT, "stop", self.server_folder, "immediate"])
        self.store = run.stdout.strip()

    def test_a_server_that_crashes_and_comes_back(self):
        folders = [self.folder(f"c{i}", sweep(i / 10, 2e-6 + 1e-9 * i), circle(i / 10, 4.0 + 0.01 * i, 0.2)) for i in range(150)]
        run = subprocess.Popen([PROGRAM, "history", "add", *folders, "--store", self.store], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
        for _ in range(2):
            time.sleep(0.3)
            subprocess.run([self.SCRIPT, "stop", self.server_folder, "immediate"], check=True)
            subprocess.run([self.SCRIPT, "again", self.server_folder], check=True)
        said, errors = run.communicate(timeout=120)
        self.assertEqual((run.returncode, errors), (0, ""))
        self.assertEqual(said.count("\n"), 150)
        self.assertEqual(len(self.data("list")["campaigns"]), 150)
        rows = list(csv.DictReader(io.StringIO(self.history("export"))))
        self.assertEqual(len(rows), 150 * 4)
        self.assertIn("EYX straightness", self.history("trend", "EYX.straightness_um"))
        self.history("forget", 1)
        self.assertIn("campaign 1: is not in", self.run_program("1", "--store", self.store, command="history show").stderr)


if __name__ == "__main__":
    unittest.main()
