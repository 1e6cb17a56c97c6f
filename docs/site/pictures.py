"""What each cause looks like: pictures by the virtual rig.

    pictures.draw(program, machine, "backlash", "X", folder / "backlash.svg")

One machine is recorded twice with the same noise, with the cause and without. Drawn is the change of the channel that
varies most against its noise, in the run that shows it best: over the position of the axis in a sweep, over the angle
on a circle, else over time; each direction of motion has its own colour. The size is the one that the seed draws.
"""
import json
import pathlib
import subprocess
import tempfile

import h5py
import matplotlib
import numpy as np

matplotlib.use("svg")
import matplotlib.pyplot as plt

SEED = 7
NOISE = {"um": 0.02, "rad": 3e-6, "mm": 1e-4}  # about that of the demonstration machine, by unit
FORWARD, BACKWARD = "#0b62a4", "#d1495b"
matplotlib.rcParams.update({"svg.hashsalt": "abbe", "font.size": 9, "axes.spines.top": False,
                            "axes.spines.right": False})


def record(program, machine, folder, *hidden):
    subprocess.run([program, "rig", "record", "--machine", machine, "--seed", str(SEED), "--campaign", "standard",
                    "--reduced", "--out", folder / "runs", "--truth", folder / "truth.json", *hidden], check=True,
                   stdout=subprocess.DEVNULL)
    runs = {}
    for file in sorted((folder / "runs").glob("*.h5")):
        with h5py.File(file) as read:
            runs[file.stem] = {name: np.asarray(column) for name, column in read.items()}
    return runs, json.loads((folder / "truth.json").read_text())


def channels(run):
    """Readings with the noise of their unit."""
    for name in run:
        unit = name.rsplit("_", 1)[-1]
        if name.startswith(("probe_", "pivot_", "ref_")) and unit in NOISE:
            yield name, NOISE[unit]


def strongest(before, after):
    """The run and the channel whose change varies most against their noise."""
    def change(run, name, noise):
        return np.nanstd(after[run][name] - before[run][name]) / noise
    return max(((change(run, name, noise), run, name) for run in before for name, noise in channels(before[run])),
               key=lambda each: each[0])[1:]


def variable(run, columns):
    """Over what a run is drawn: values and label."""
    if "_sweep_" in run:
        axis = run[-1]
        return columns[f"{axis.lower()}_mm"], f"{axis} in mm"
    if "_circle_" in run:
        first, second = (columns[f"{axis.lower()}_mm"] for axis in run.split("_")[2])
        return np.degrees(np.arctan2(second - second.mean(), first - first.mean())), "angle in degrees"
    return columns["time_s"] - columns["time_s"][0], "time in s"


def words(truth):
    sizes = ", ".join(f"{key} {value:.3g}" for key, value in truth["parameters"].items()
                      if isinstance(value, (int, float)))
    return f"{truth['object']}: {sizes}" if sizes else truth["object"]


def draw(program, machine, cause, thing, out):
    """Returns the caption; the picture is a file `out` (SVG)."""
    with tempfile.TemporaryDirectory() as folder:
        before, _ = record(program, machine, pathlib.Path(folder))
        after, truth = record(program, machine, pathlib.Path(folder), "--force", "--hide", f"{cause}:object={thing}")
    run, channel = strongest(before, after)
    columns = before[run]
    x, label = variable(run, columns)
    change = after[run][channel] - columns[channel]
    unit = channel.rsplit("_", 1)[-1]
    scale, unit = {"um": (1.0, "um"), "mm": (1e3, "um"), "rad": (1e6, "urad")}[unit]
    forward = columns["direction"] > 0 if "direction" in columns else np.ones(len(x), bool)
    figure, axes = plt.subplots(figsize=(6.4, 2.6), layout="constrained")
    for which, colour, way in ((forward, FORWARD, "forward"), (~forward, BACKWARD, "backward")):
        if which.any():
            axes.plot(x[which], scale * change[which], ".", ms=2.5, color=colour, label=way)
    if forward.any() and (~forward).any():
        axes.legend(frameon=False, markerscale=3)
    axes.set_xlabel(label)
    axes.set_ylabel(f"change of {channel.rsplit('_', 1)[0]} in {unit}")
    figure.savefig(out, metadata={"Date": None})
    plt.close(figure)
    return f"{words(truth['hidden'][0])}; run {run}"
