"""abbe study: the same store however it is worked out, what a kill loses, what bad input says; the study of the head
against closed forms."""
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from program_case import MACHINE, PROGRAM, ProgramCase

WORLDS = 200


class StudyOfTheHead(ProgramCase):
    command = "study head"

    def study(self, name, *arguments, machine=MACHINE, worlds=WORLDS, ranks=None):
        """The bytes of a store."""
        store = self.path / name
        call = [PROGRAM, "study", "head", "--machine", machine, "--worlds", str(worlds), "--store", store, "--quiet"]
        if ranks:
            call = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *call]
        run = subprocess.run([*map(str, call), *map(str, arguments)], capture_output=True, text=True, timeout=100)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return store.read_bytes()

    def test_threads_shards_and_another_order_give_the_same_bytes(self):
        whole = self.study("whole.jsonl", "--threads", 1)
        self.assertEqual(self.study("four.jsonl", "--threads", 4), whole)
        for k in (1, 2, 3):
            self.study(f"{k}.jsonl", "--shard", f"{k}/3")
        self.done(*(self.path / f"{k}.jsonl" for k in (3, 1, 2)), "-o", self.path / "merged.jsonl",
                  command="study merge")
        self.assertEqual((self.path / "merged.jsonl").read_bytes(), whole)

    @unittest.skipUnless(shutil.which("mpirun"), "mpirun is not installed")
    def test_ranks_give_the_same_bytes(self):
        if "MPI: yes" not in self.done(command="--version"):
            self.skipTest("built without MPI")
        whole = self.study("whole.jsonl", "--threads", 1)
        for ranks in (1, 2, 4):
            self.assertEqual(self.study(f"{ranks}.jsonl", ranks=ranks), whole)

    @unittest.skipUnless(shutil.which("mpirun"), "mpirun is not installed")
    def test_ranks_end_where_the_question_is_wrong(self):
        (self.path / "there.jsonl").write_text("")
        run = subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "3", PROGRAM, "study", "head",
                              "--machine", MACHINE, "--store", self.path / "there.jsonl"], capture_output=True,
                             text=True, timeout=60)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertIn("there.jsonl: exists already; --resume", run.stderr)

    def killed(self, call, rows):
        """Starts, waits for so many rows and kills the whole group."""
        store = self.path / "killed.jsonl"
        with subprocess.Popen([*map(str, call), "--store", store, "--quiet"], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, start_new_session=True) as run:
            for _ in range(1000):
                if store.exists() and store.read_bytes().count(b"\n") > rows:
                    break
                time.sleep(0.01)
            seen = store.read_bytes().count(b"\n")
            os.killpg(run.pid, signal.SIGKILL)
        self.assertGreater(seen, rows)
        lines = store.read_bytes().split(b"\n")
        self.assertGreaterEqual(len(lines) - 1, seen)
        self.assertLess(len(lines) - 2, 20 * WORLDS)  # it was not done
        return store

    def test_a_kill_loses_no_row_that_was_kept(self):
        options = ["--machine", MACHINE, "--worlds", str(20 * WORLDS)]
        store = self.killed([PROGRAM, "study", "head", *options], 20)
        store.write_bytes(store.read_bytes() + b'{"seed":77,"one":[0.1')
        self.done(*options, "--store", store, "--resume", "--quiet")
        self.assertEqual(store.read_bytes(), self.study("whole.jsonl", worlds=20 * WORLDS))

    def test_more_worlds_go_on(self):
        self.study("less.jsonl", worlds=50)
        self.assertEqual(self.study("less.jsonl", "--resume"), self.study("whole.jsonl"))

    def test_a_store_that_was_damaged_is_refused(self):
        lines = self.study("head.jsonl", worlds=3).decode().splitlines()
        row = json.loads(lines[1])
        for key, value in (("one", row["one"][:-1]), ("gains", []), ("stations_m", row["stations_m"][:3]), ("other", "a"),
                           ("motion", None)):
            damaged = json.dumps({**row, key: value})
            (self.path / "damaged.jsonl").write_text("\n".join([lines[0], damaged, *lines[2:]]) + "\n")
            run = self.run_program(self.path / "damaged.jsonl", command="study show")
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertRegex(run.stderr, r"^abbe: .*damaged.jsonl: a row (has \d+ numbers of|lacks what)[^\n]*\n$")

    def test_noise_reaches_the_angles_as_in_closed_form(self):
        # Roll (B - C) / 2l, pitch ((B + C) / 2 - A) / l, yaw (E - D) / l of readings with the noise of five passes of
        # 2 x 0.5 s x 200 Hz, 20 nm white and 30 nm of drift, l = 10 mm; relative to the first station.
        sigma = math.hypot(20e-9 / math.sqrt(1000), 30e-9 / math.sqrt(5))
        expected = [sigma * factor / 10e-3 for factor in (1.0, math.sqrt(3.0), 2.0)]
        lines = self.study("head.jsonl", worlds=2000).decode().splitlines()[1:]
        rows = [json.loads(line)["one"] for line in lines]
        for component, sd in enumerate(expected):
            for station in (1, 6):
                values = [row[5 * station + component] for row in rows]
                found = math.sqrt(sum(value**2 for value in values) / len(values))
                self.assertAlmostEqual(found / sd, 1.0, delta=0.06)  # 1.6 % is one standard deviation

    def test_a_product_is_of_both_its_factors(self):
        # Without noise the errors are gains times motions, which share nothing alone: the total index of either is 1.
        text = pathlib.Path(MACHINE).read_text()
        for line, none in (("probe_nm = 20.0", "probe_nm = 0.0"), ("drift_nm = 30.0", "drift_nm = 0.0"),
                           ("probe_position_um = 10.0", "probe_position_um = 0.0"),
                           ("installation_urad = 500.0", "installation_urad = 0.0"),
                           ("installation_um = 50.0", "installation_um = 0.0")):
            self.assertIn(line, text)
            text = text.replace(line, none)
        (self.path / "quiet.toml").write_text(text)
        self.study("quiet.jsonl", machine=self.path / "quiet.toml", worlds=2000)
        shown = self.done(self.path / "quiet.jsonl", command="study show")
        shares = {row.split("|")[1].strip(): [float(cell.split("+-")[0]) for cell in row.split("|")[2:7]]
                  for row in shown.split("Share of each factor")[1].splitlines() if row.count("|") == 7
                  and row.split("|")[2].strip()[0].isdigit()}
        for factor in ("motion", "gains"):
            for share in shares[factor]:
                self.assertAlmostEqual(share, 1.0, delta=0.1)
        for factor in ("noise", "installation", "probe positions"):
            self.assertEqual(shares[factor], [0.0] * 5)

    def test_bad_input_says_what_to_do(self):
        self.study("once.jsonl", worlds=5)
        there = ["--machine", MACHINE, "--store", self.path / "once.jsonl"]
        self.refuse(*there, saying=["exists already", "--resume"])
        self.refuse(*there, "--resume", "--variant", "Z", saying=["asks", "another name"])
        self.refuse("--machine", MACHINE, "--store", self.path / "new.jsonl", "--shard", "4/3", saying=["--shard 4/3"])
        self.refuse("--machine", MACHINE, "--store", "/proc/nowhere/new.jsonl", saying=["/proc/nowhere/new.jsonl"])
        self.refuse("--machine", MACHINE, "--store", MACHINE, "--resume", saying=["demo_mill.toml:1", "abbe study"])
        one_axis = self.path / "none.toml"
        one_axis.write_text('name = "x"\n')
        self.refuse("--machine", one_axis, "--store", self.path / "new.jsonl", saying=["none.toml"])
        self.assertFalse((self.path / "new.jsonl").exists())
        run = self.run_program(self.path / "once.jsonl", MACHINE, command="study show")
        self.assertEqual(run.returncode, 2)


class StudiesOfWorlds(ProgramCase):
    def test_what_a_study_ends_with_is_what_its_store_shows(self):
        # Rows that were just made are summed up as those that are read.
        store = self.path / "circle.jsonl"
        told = self.done("--machine", MACHINE, "--worlds", 2, "--store", store, "--quiet", command="study circle")
        self.assertIn("| worlds |", told)
        self.assertIn(self.done(store, command="study show").strip(), told)


if __name__ == "__main__":
    unittest.main()
