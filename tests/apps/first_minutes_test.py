#!/usr/bin/env python3
"""The first minutes with abbe: `abbe init` writes machine files that the commands take, `abbe doctor` looks at computer
and devices, help, manual pages and completion come from the definitions of the commands.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml first_minutes_test.py
"""
import json
import math
import os
import pathlib
import pty
import random
import re
import shutil
import socket
import subprocess
import time
import tomllib
import unittest

import numpy as np

import arm_fit
from program_case import MACHINE, PROGRAM, ProgramCase

INI = pathlib.Path("/usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/axis_mm.ini")


class InitTest(ProgramCase):
    command = "init"

    def made(self, kind, *options):
        path = self.path / f"{kind}.toml"
        self.done("--kind", kind, "--out", path, *options)
        return path

    def ready(self, path):
        """Commands of a file and what they lack."""
        return dict(line.split(": ", 1) for line in self.done("--check", path).splitlines())

    def measured(self, kind, axes):
        """A machine of this kind is swept (virtual rig), reduced, fused, exported and corrects a program."""
        travels = [word for axis in axes for word in (f"--travel-{axis.lower()}", "0,60")]
        path = self.made(kind, *travels, "--head", "--name", "my-" + kind)
        text = path.read_text()
        self.assertEqual(tomllib.loads(text)["name"], "my-" + kind)
        self.assertEqual(self.ready(path)["align, sweep"], "ready")
        path.write_text(re.sub(r"(?m)^passes = .*", "passes = 3", re.sub(r"step_mm = .*", "step_mm = 5.0", text)))
        sweeps = [self.rig_record(f"{axis}.csv", "--axis", axis, "--rate", 50, machine=path) for axis in axes]
        for axis, sweep in zip(axes, sweeps):
            self.assertIn(f"E{'Y' if axis == 'X' else 'X'}{axis}", self.done(sweep, "--machine", path, command="reduce"))
        out = self.path / "map.toml"
        self.done(*sweeps, "--machine", path, "-o", out, "--fixed-smoothness", command="fuse")
        return out

    def test_a_name_may_hold_quotes(self):
        path = self.made("shaft", "--name", 'wheel "7" \\ left')
        self.assertEqual(tomllib.loads(path.read_text())["name"], 'wheel "7" \\ left')

    def test_a_person_is_asked_again_after_a_slip(self):
        ours, theirs = pty.openpty()
        path = self.path / "asked.toml"
        asked = subprocess.Popen([PROGRAM, "init", "--out", path], stdin=theirs, stdout=theirs, stderr=theirs)
        os.close(theirs)
        os.write(ours, b"miill\nmill\nmill-3\n0;500\n300,0\n0,300\n0,200\n0,250\nboth\ncarriage\nmaybe\ny\n")
        said = b""
        while True:
            try:
                said += os.read(ours, 4096)
            except OSError:  # it has ended
                break
        os.close(ours)
        self.assertEqual(asked.wait(timeout=60), 0, said)
        machine = tomllib.loads(path.read_text())
        self.assertEqual((machine["name"], machine["axis"]["X"]["travel_mm"]), ("mill-3", [0, 300]))
        self.assertEqual(machine["axis"]["X"]["positive"], "carriage")
        self.assertIn("probe_a", machine["head"])

    def test_a_mill_and_a_gantry_are_measured_mapped_and_corrected(self):
        for kind in ("mill", "gantry"):
            with self.subTest(kind):
                out = self.measured(kind, "XYZ")
                (self.path / "part.ngc").write_text("G21 G90 G17\nG0 X5 Y5 Z5\nG1 X50 Y40 Z30 F500\nM30\n")
                self.assertIn("corrected by up to", self.done(out, self.path / "part.ngc", "--force", command="correct"))
                self.done(out, "--format", "csv", "--points", 5, "--out", self.path / f"{kind}.csv", command="export")

    def test_a_lathe_and_one_axis_are_measured_and_mapped(self):
        for kind, axes in (("lathe", "XZ"), ("axis", "X")):
            with self.subTest(kind):
                self.assertIn("[[error]]", self.measured(kind, axes).read_text())
                (self.path / "map.toml").unlink()

    def test_an_arm_is_calibrated(self):
        path = self.made("arm")
        rows = [tuple(math.radians(joint.get(key, 0.0)) if key.endswith("deg") else joint.get(key, 0.0)
                      for key in ("theta_deg", "d_mm", "a_mm", "alpha_deg")) + (0.0,)
                for joint in tomllib.loads(path.read_text())["linkage"]["joint"]]
        draw = random.Random(5)
        q = np.array([[draw.uniform(-1.5, 1.5) for _ in rows] for _ in range(120)])
        true = [(theta, d + 0.3 * (n == 0), a + 0.4 * (n == 1), alpha, beta)
                for n, (theta, d, a, alpha, beta) in enumerate(rows)]
        seen = arm_fit.tips(true, (0.5, 0.0, 100.0), q) + [900.0, 200.0, -50.0]
        lines = ["# abbe-recording = 1", '# kind = "linkage"', '# time = "order"',
                 ",".join(["time_s", *(f"pivot_{i + 1}_rad" for i in range(len(rows))), "ref_x_mm", "ref_y_mm", "ref_z_mm"])]
        for n, (angles, place) in enumerate(zip(q, seen)):
            lines.append(",".join([str(n), *(f"{v:.9f}" for v in angles), *(f"{v + draw.gauss(0, 5e-3):.6f}" for v in place)]))
        (self.path / "poses.csv").write_text("\n".join(lines) + "\n")
        self.assertEqual(self.ready(path)["calibrate, diagnose of an arm"], "ready")
        self.done(self.path / "poses.csv", "--machine", path, "-o", self.path / "now.toml", "--json",
                  self.path / "now.json", command="calibrate")
        recording = json.loads((self.path / "now.json").read_text())["recordings"][0]
        self.assertLess(recording["after"]["rms_mm"], 0.02)
        self.assertGreater(recording["before"]["rms_mm"], 0.1)

    def test_a_shaft_is_diagnosed(self):
        path = self.made("shaft", "--name", "wheel")
        draw = random.Random(3)
        lines = ["# abbe-recording = 1", '# kind = "shaft"', '# machine = "wheel"', "# sensor_deg = [0.0, 120.0, 240.0]",
                 "time_s,shaft_deg,gap_1_mm,gap_2_mm,gap_3_mm"]
        for row in range(1200):
            angle = row * 0.9
            gaps = [0.5 + 0.03 * math.cos(math.radians(angle - at)) + draw.gauss(0, 2e-4) for at in (0, 120, 240)]
            lines.append(",".join([f"{row / 40:.3f}", f"{angle:.6f}", *(f"{gap:.7f}" for gap in gaps)]))
        (self.path / "turn.csv").write_text("\n".join(lines) + "\n")
        self.assertIn("target-eccentricity", self.done(self.path / "turn.csv", "--machine", path, command="diagnose"))

    def test_the_check_names_what_is_missing(self):
        ready = self.ready(self.made("mill"))
        self.assertIn("[head]", ready["align, sweep"])
        self.assertIn("[devices.NAME]", ready["record, doctor"])
        self.assertEqual(ready["circle, path, plate, fuse, diagnose of a machine"], "ready")
        one = self.ready(self.made("axis"))
        self.assertEqual(one["path, fuse, diagnose of a machine"], "ready")
        self.assertIn("a second axis", one["circle"])
        self.assertIn("YZ, for a volume", one["plate"])
        lathe = self.ready(self.made("lathe"))
        self.assertEqual(lathe["circle"], "ready")
        self.assertIn("Y, for a volume", lathe["plate"])
        wrong = self.path / "wrong.toml"
        wrong.write_text(self.made("gantry").read_text().replace("travel_mm", "travle_mm", 1))
        self.refuse("--check", wrong, saying=["wrong.toml:", "travel_mm"])

    def test_the_steps_of_a_sweep_divide_any_travel(self):
        for travel in ("0,500", "0,437.5", "-254,254", "-50.8,101.6", "0,60", "0,7.3"):
            path = self.made("axis", "--head", "--force", "--travel-x=" + travel)
            self.assertEqual(self.ready(path)["align, sweep"], "ready", travel)

    def test_it_asks(self):
        answers = "mill\nshop-3\n0,800\n0,500\n-400,0\ncarriage\nno\n"
        path = self.path / "asked.toml"
        done = subprocess.run([PROGRAM, "init", "--ask", "--out", path], input=answers, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = tomllib.loads(path.read_text())
        self.assertEqual((told["name"], told["axis"]["Z"]["travel_mm"], told["axis"]["X"]["positive"]),
                         ("shop-3", [-400, 0], "carriage"))
        self.assertNotIn("head", told)
        done = subprocess.run([PROGRAM, "init", "--out", self.path / "n.toml"], input="", capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--kind mill", done.stderr)
        done = subprocess.run([PROGRAM, "init", "--ask", "--out", self.path / "n.toml"], input="mill\nx\n1-2\n",
                              capture_output=True, text=True)
        self.assertIn("a travel is two numbers", done.stderr)
        self.assertFalse((self.path / "n.toml").exists())

    def test_travels_that_nobody_stated_are_said(self):
        out = self.path / "m.toml"
        said = self.done("--kind", "mill", "--travel-y", "0,300", "--out", out)
        self.assertIn("write your travels: those of X, Z were not stated", said)
        said = self.done("--kind", "axis", "--travel-x", "0,300", "--out", out, "--force")
        self.assertNotIn("write your travels", said)

    def test_it_refuses_what_is_no_machine(self):
        out = ["--out", self.path / "n.toml"]
        self.refuse("--kind", "mill", "--travel-x", "5,5", *out, saying=["X goes from 5 to 5 mm"])
        self.assertFalse((self.path / "n.toml").exists())
        kept = self.made("shaft")
        self.refuse("--kind", "mill", "--out", kept, saying=["shaft.toml: is there already"])
        self.assertNotIn("chain", kept.read_text())
        self.refuse("--kind", "lathe", "--travel-y", "0,100", *out, saying=["--travel-y", "kind lathe has no axis Y"])
        self.refuse("--kind", "shaft", "--head", *out, saying=["--head belongs to a machine with axes"])
        (self.path / "a.ini").write_text("[KINS]\nKINEMATICS = scarakins\n")
        self.refuse("--ini", self.path / "a.ini", *out, saying=["scarakins"])
        (self.path / "a.ini").write_text("[TRAJ]\nLINEAR_UNITS = mm\n")
        self.refuse("--ini", self.path / "a.ini", *out, saying=["[AXIS_X] MIN_LIMIT"])

    def test_inches_of_an_ini_file_become_millimetres(self):
        text = "[EMC]\nMACHINE = My Mill\n[TRAJ]\n@\n"
        text += "".join(f"[AXIS_{axis}]\nMIN_LIMIT = -1.0\nMAX_LIMIT = 10 # in\n" for axis in "XYZ")
        ini, out = self.path / "mill.ini", self.path / "m.toml"
        for units, limits in (("inch", [-25.4, 254]), ("INCH", [-25.4, 254]), ("Imperial", [-25.4, 254]),
                              ("mm", [-1, 10]), ("Metric", [-1, 10])):
            ini.write_text(text.replace("@", f"LINEAR_UNITS = {units}"))
            self.done("--ini", ini, "--out", out, "--force")
            told = tomllib.loads(out.read_text())
            self.assertEqual((told["name"], told["axis"]["Y"]["limit_mm"]), ("My-Mill", limits), units)
        for line, said in (("LINEAR_UNITS = cubit", "LINEAR_UNITS = cubit is no unit"), ("", "LINEAR_UNITS is missing")):
            ini.write_text(text.replace("@", line))
            self.refuse("--ini", ini, "--out", out, "--force", saying=["mill.ini", said])

    @unittest.skipUnless(INI.exists(), "linuxcnc-uspace is not installed")
    def test_the_ini_file_of_linuxcnc_itself(self):
        self.done("--ini", INI, "--out", self.path / "m.toml")
        told = tomllib.loads((self.path / "m.toml").read_text())
        self.assertEqual((told["name"], told["axis"]["Z"]["travel_mm"]), ("LinuxCNC-HAL-SIM-AXIS", [-50.8, 101.6]))


class DoctorTest(ProgramCase):
    command = "doctor"

    def test_the_computer_alone(self):
        text = self.done("--out", self.path)
        self.assertIn("clock: ", text)
        self.assertRegex(text, r"disk: [\d.e+]+ GB free")

    def test_devices_that_do_not_answer(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        text = re.sub(r"(?ms)^\[devices\.linkage\].*", "", pathlib.Path(MACHINE).read_text())
        (self.path / "m.toml").write_text(text.replace("port = 1502", f"port = {port}"))
        run = self.run_program("--machine", self.path / "m.toml", "--out", self.path)
        self.assertEqual(run.returncode, 3, run.stdout + run.stderr)
        self.assertRegex(run.stdout, rf"bad +devices: .*{port}")
        self.assertIn("disk: ", run.stdout)

    def test_devices_of_the_virtual_rig(self):
        text = re.sub(r"(?ms)^\[devices\.linkage\].*", "", pathlib.Path(MACHINE).read_text())
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        (self.path / "m.toml").write_text(text.replace("port = 1502", f"port = {port}"))
        ready = self.path / "ready"
        rig = subprocess.Popen([PROGRAM, "rig", "--machine", self.path / "m.toml", "--seed", "7", "--port", str(port),
                                "--ready-file", ready], stdout=subprocess.DEVNULL)
        try:
            for _ in range(200):
                if ready.exists():
                    break
                time.sleep(0.05)
            run = self.run_program("--machine", self.path / "m.toml", "--out", self.path)
        finally:
            rig.terminate()
            rig.wait()
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertIn("devices: all 2 answer", run.stdout)
        self.assertRegex(run.stdout, r"disk: .* h of this machine")


class WordsTest(ProgramCase):
    command = "--version"

    def paths(self):
        """All commands, from the completion of fish."""
        shown = self.done(command="--help")
        return re.findall(r"(?m)^  (\w+) {2,}\S", shown[shown.index("Subcommands:"):])

    def test_the_version_tells_how_it_was_built(self):
        text = self.done()
        self.assertRegex(text, r"^abbe \d+\.\d+\.\d+\ncompiler .+, C\+\+ 2020")
        self.assertRegex(text, r"live page: (yes|no); history: (yes|no)")

    def test_every_command_helps_with_an_example(self):
        names = self.paths()
        self.assertGreater(len(names), 20)
        for name in names:
            self.assertRegex(self.done(command=f"{name} --help"), "Example", name)

    def completed(self, line):
        """What bash offers at the end of a line."""
        (self.path / "abbe.bash").write_text(self.done("bash", command="completion"))
        words = line.split(" ")
        script = (f"source {self.path}/abbe.bash; COMP_WORDS=({' '.join(repr(word) for word in words)}); "
                  f"COMP_CWORD={len(words) - 1}; _abbe; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
        return subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.split()

    def test_bash_completes_commands_options_and_values(self):
        self.assertEqual(self.completed("abbe cor"), ["correct"])
        self.assertIn("record", self.completed("abbe rig rec"))
        self.assertEqual(self.completed("abbe correct --par"), ["--parameters"])
        self.assertEqual(sorted(self.completed("abbe init --kind ")), ["arm", "axis", "gantry", "lathe", "mill", "shaft"])
        self.assertEqual(self.completed("abbe correct --block-delete o"), ["on", "off"])
        self.assertTrue({"bash", "fish", "zsh"} <= set(self.completed("abbe completion ")))
        self.assertEqual(self.completed("abbe export map.toml --format li"), ["linuxcnc", "linuxcnc-hal"])

    def test_fish_and_zsh_have_the_same_words(self):
        fish = self.done("fish", command="completion")
        for name in self.paths():
            self.assertRegex(fish, rf"-n '__fish_use_subcommand' -a {name} ")
        self.assertRegex(fish, r"-n '__fish_seen_subcommand_from correct' -l tools -r")
        self.assertTrue(self.done("zsh", command="completion").startswith("#compdef abbe\n"))

    @unittest.skipUnless(shutil.which("fish"), "needs fish")
    def test_fish_completes_commands_options_and_values(self):
        (self.path / "abbe.fish").write_text(self.done("fish", command="completion"))

        def completed(line):
            """What fish offers at the end of a line."""
            script = f"source {self.path}/abbe.fish; complete -C '{line}'"
            done = subprocess.run(["fish", "-N", "-c", script], capture_output=True, text=True, check=True,
                                  cwd=self.path, env={**os.environ, "HOME": str(self.path)})
            self.assertEqual(done.stderr, "")
            return [offered.split("\t")[0] for offered in done.stdout.splitlines()]

        self.assertEqual(completed("abbe cor"), ["correct"])
        self.assertIn("record", completed("abbe rig rec"))
        self.assertEqual(completed("abbe correct --par"), ["--parameters"])
        self.assertEqual(completed("abbe correct --block-delete o"), ["off", "on"])
        self.assertEqual(completed("abbe completion "), ["bash", "fish", "zsh"])
        # Options of `abbe record` are not those of `abbe rig record`.
        self.assertEqual((completed("abbe record --dev"), completed("abbe rig record --dev")), (["--devices"], []))

    @unittest.skipUnless(shutil.which("zsh"), "needs zsh")
    def test_zsh_completes_at_the_first_tab(self):
        (self.path / "_abbe").write_text(self.done("zsh", command="completion"))

        def assert_completed(line, rest):
            """One TAB behind `line` adds `rest`. A zsh as in a terminal, which reads the file only now."""
            script = (f"zmodload zsh/zpty; zpty -b z zsh -f -i\n"
                      f"zpty -w z \"PS1=; fpath=({self.path} \\$fpath); autoload -U compinit; compinit -u -D; "
                      f"bindkey '^I' complete-word; print re''ady\"\n"
                      f"zpty -r z out '*ready*'; zpty -w -n z $'{line}\\t'; zpty -r z out '*{rest}*'; print -r -- $out")
            done = subprocess.run(["zsh", "-f", "-c", script], capture_output=True, text=True, timeout=30,
                                  env={**os.environ, "HOME": str(self.path), "TERM": "vt100"})
            self.assertIn(rest, done.stdout)

        assert_completed("abbe di", "agnose")
        assert_completed("abbe rig rec", "ord")
        assert_completed("abbe correct --par", "ameters")

    def test_manual_pages_are_troff(self):
        self.done("--out", self.path / "man1", command="man")
        pages = sorted((self.path / "man1").glob("*.1"))
        self.assertGreater(len(pages), len(self.paths()))
        for page in pages:
            if shutil.which("groff"):
                done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", page], capture_output=True, text=True,
                                      env={**os.environ, "LC_ALL": "C.UTF-8"})
                self.assertEqual((done.returncode, done.stderr), (0, ""), page)
        text = (self.path / "man1" / "abbe-correct.1").read_text()
        self.assertIn("\\-\\-work\\-offset", text)
        self.assertIn("abbe correct out/map.toml part.ngc", text)


if __name__ == "__main__":
    unittest.main()
