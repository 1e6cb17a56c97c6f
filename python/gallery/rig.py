"""Data of the virtual rig for the examples: `abbe rig record` of the program abbe, found by ABBE or the path."""
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MACHINE = ROOT / "machines" / "demo_mill.toml"


def folder():
    """Where the data and the picture go: the argument of the example, else a folder of its name."""
    path = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(sys.argv[0]).stem)
    path.mkdir(parents=True, exist_ok=True)
    return path


def record(path, *options, seed=7):
    """A recording of the virtual machine, or a folder of them; returns the path."""
    program = os.environ.get("ABBE", "abbe")
    subprocess.run([program, "rig", "record", "--machine", MACHINE, "--seed", str(seed), "--out", path, "--force",
                    *options], check=True, stdout=subprocess.DEVNULL)
    return path
