"""abbe fleet fit: campaigns in, the population and what is odd out; the store goes on; bad input."""
import json
import pathlib
import tomllib
import unittest

from program_case import MACHINE, ProgramCase


class Fleet(ProgramCase):
    command = "fleet fit"

    def campaign(self, name, seed, run=1):
        """A folder with a short sweep of each axis."""
        folder = self.path / name
        folder.mkdir()
        short = self.path / "short.toml"
        text = pathlib.Path(MACHINE).read_text()
        short.write_text(text.replace("step_mm = 1.0", "step_mm = 5.0").replace("dwell_s = 0.5", "dwell_s = 0.1"))
        for axis in "XYZ":
            self.done("--machine", short, "--seed", seed, "--run", run, "--axis", axis, "--out", folder / f"{axis}.h5",
                      command="rig record")
        return folder

    def test_a_fleet(self):
        given = [f"M{seed}={self.campaign(f'm{seed}', seed)}" for seed in (1, 2, 3)]
        options = ["--machine", MACHINE, "--store", self.path / "fleet.jsonl", "--quiet"]
        first = self.done(*given, *options, "-o", self.path / "population.toml")
        self.assertIn("3 machines", first)
        population = tomllib.loads((self.path / "population.toml").read_text())["population"]
        self.assertEqual(set(population), set(tomllib.loads(pathlib.Path(MACHINE).read_text())["population"]))
        # Sweeps see no positioning: that line stays as it was.
        self.assertEqual(population["positioning_um"], 2.0)
        self.assertIn("the fleet does not tell", first)
        kept = (self.path / "fleet.jsonl").read_bytes()
        self.assertEqual(self.done(*options, "--resume"), first.split("\nfor the machine file")[0])  # all that the store has
        self.assertEqual((self.path / "fleet.jsonl").read_bytes(), kept)
        # A later campaign of the second machine goes under the name of the first.
        later = self.campaign("later", 2, run=2)
        self.done(*given, f"M1={later}", *options, "--resume", "--json", self.path / "fleet.json")
        odd = json.loads((self.path / "fleet.json").read_text())["odd_identities"]
        self.assertIn(("later", "M1", "M2"),
                      [(pathlib.Path(each["campaign"]).name, each["said"], each["fits"]) for each in odd])

    def test_bad_input_says_what_to_do(self):
        options = ["--machine", MACHINE, "--store", self.path / "fleet.jsonl"]
        folder = self.campaign("m1", 1)
        (self.path / "empty").mkdir()
        self.refuse("M1", *options, saying=["MACHINE=FOLDER"])
        self.refuse("M1=nowhere", *options, saying=["nowhere: cannot be read as a folder"])
        self.refuse(f"M1={self.path / 'empty'}", *options, saying=["has no recording that makes a map"])
        self.refuse(f"M1={folder}", f"M1={folder}", *options, saying=["is given twice"])
        self.assertFalse((self.path / "fleet.jsonl").exists())
        self.refuse(*options, saying=["fleet needs a campaign"])
        self.refuse(f"M1={folder}", *options, saying=["exists already", "--resume"])
        # A store that was damaged: numbers that are missing, and information that is none.
        self.done(f"M1={folder}", "--machine", MACHINE, "--store", self.path / "one.jsonl", "--quiet")
        lines = (self.path / "one.jsonl").read_text().splitlines()
        for key, change in (("information", lambda numbers: numbers[:-1]), ("vector", lambda numbers: numbers + [1.0]),
                            ("information", lambda numbers: [-1.0, *numbers[1:]]), ("campaign", lambda name: 7)):
            row = json.loads(lines[1])
            row[key] = change(row[key])
            (self.path / "one.jsonl").write_text(lines[0] + "\n" + json.dumps(row) + "\n")
            self.refuse("--machine", MACHINE, "--store", self.path / "one.jsonl", "--resume", saying=["one.jsonl: "])
        (self.path / "other.toml").write_text(
            pathlib.Path(MACHINE).read_text().replace("smoothness_mm = 15.0", "smoothness_mm = 20.0"))
        self.refuse(f"M1={folder}", "--machine", self.path / "other.toml", "--store", self.path / "fleet.jsonl",
                    "--resume", saying=["asks", "another name"])


if __name__ == "__main__":
    unittest.main()
