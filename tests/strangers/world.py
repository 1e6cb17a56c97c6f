"""A world: machine, head, target, linkage, weather and noise of one seed, and at most one hidden effect.

Everything is drawn from streams of their own, so the same seed with and without an effect has the same
machine, the same runs and the same noise, and the difference of both is the effect.
"""
import datetime
import pathlib
import tomllib
import types

import numpy as np

from campaign import plan
from instruments import Head, Linkage, Target
from machine import Machine, apply, inverse, joined

STREAMS = {"machine": 1, "head": 2, "target": 3, "linkage": 4, "plan": 5, "noise": 6, "effect": 7}
PROBES = [f"probe_{p}_um" for p in "abcde"]
PIVOTS = [f"pivot_{i}_rad" for i in (1, 2, 3)]


def walk(draw, t, size, time):
    """A drift that forgets itself within `time`: exact at any times (Ornstein and Uhlenbeck)."""
    value = np.empty(len(t))
    value[0] = size * draw.normal()
    keep = np.exp(-np.diff(t) / time)
    step = size * np.sqrt(1 - keep**2) * draw.normal(size=len(t) - 1)
    for i in range(1, len(t)):
        value[i] = keep[i - 1] * value[i - 1] + step[i - 1]
    return value


def white(draw, run, columns):
    return draw.normal(size=(len(run.t), columns))


class World:
    def __init__(self, seed, machine_file, effect=None, wide=False):
        self.seed, self.file = seed, machine_file
        self.settings = tomllib.loads(pathlib.Path(machine_file).read_text(encoding="utf-8"))
        s = self.settings
        self.runs = plan(self.stream("plan"), wide)
        self.effect = effect(self.stream("effect"), self.runs) if effect else None
        self.hooks = self.effect.hooks if effect else {}
        self.machine = Machine(self.stream("machine"), s["population"], **self.hooks.get("machine", {}))
        self.head = Head(self.stream("head"), s["head"])
        self.target = Target(self.stream("target"), s["target"], self.hooks.get("form", 1.0))
        again = self.stream("target", 1)
        self.targets = {"first": self.target, "second": self.target.mounted_again(again)}
        self.linkage = Linkage(self.stream("linkage"), s["linkage"])

    def stream(self, name, *more):
        return np.random.default_rng([self.seed, STREAMS[name], *more])

    def hook(self, name, run, *values, otherwise=0.0):
        return self.hooks[name](run, *values) if name in self.hooks else otherwise

    def poses(self, run):
        """Workpiece and tool seen from the bed in each row."""
        more = {a: np.zeros((len(run.q), 6)) for a in "XYZ"}
        for axis, value in self.hook("carriage", run, otherwise={}).items():
            more[axis] = more[axis] + value
        return self.machine.poses(run.q + self.hook("travel", run), more)

    def exact(self, run):
        """Gaps (n, 5) in m and angles (n, 3) in rad without noise; None where the run has none."""
        work, tool = self.poses(run)
        gaps = angles = None
        if run.probes:
            gaps = self.head.gaps(run.axis, work, tool, self.targets[run.mounting])
            gaps = gaps + self.hook("gaps", run, gaps)
        if run.pivots:
            ball = np.broadcast_to(self.hook("ball", run), run.q.shape)
            angles = self.linkage.angles(work, tool, run.temps[:, 1], ball)
            angles = angles + self.hook("angles", run, angles)
        return gaps, angles

    def noise(self, run):
        s = self.settings["noise"]
        draw = [self.stream("noise", run.number, k) for k in range(3)]
        slow = np.stack([walk(draw[0], run.t, s["drift_nm"] * 1e-9, s["drift_time_s"]) for _ in range(5)], axis=1)
        quick = self.hooks.get("probe_noise", white)(draw[1], run, 5) * s["probe_nm"] * 1e-9
        encoder = self.hooks.get("encoder_noise", white)(draw[2], run, 3)
        return slow + quick, encoder * self.settings["linkage"]["noise"]["encoder_urad"] * 1e-6

    def readings(self, run):
        gaps, angles = self.exact(run)
        probe, encoder = self.noise(run)
        return (None if gaps is None else gaps + probe), (None if angles is None else angles + encoder)

    def tip(self, q, tool=(0.0, 0.0, 0.0)):
        """The tool point in the workpiece (n, 3) at positions q, by the errors of the machine and by an effect that
        depends on the positions alone, not on time or the way that led there."""
        try:
            work, carried = self.poses(types.SimpleNamespace(q=q))
        except AttributeError:
            work, carried = self.machine.poses(q, {a: np.zeros((len(q), 6)) for a in "XYZ"})
        R, p = joined(inverse(work), carried)
        return p + apply(R, tool)

    def tool_error(self, q, tool):
        """Where the tool point is less where it should be, (n, 3); X and Y carry the workpiece."""
        return self.tip(q, tool) - (np.array(tool) + q * [-1, -1, 1])

    def lengths(self, run):
        """The calibrated distance from the first row: the line stands on the table, the tool points at it."""
        work, carried = self.poses(run)
        place = joined(inverse(work), carried)[1]
        noise = 1e-7 * self.stream("noise", run.number, 3).normal(size=len(run.t))
        scale = 1 + 2e-6 * self.stream("noise", run.number, 4).normal()
        return np.where(np.arange(len(run.t)) == 0, 0.0,
                        np.linalg.norm(place - place[0], axis=1) * scale + noise)

    def write(self, run, folder):
        """The recording as a CSV file of docs/recordings.md."""
        columns = [("time_s", run.t, "%.4f")]
        columns += [(f"{a}_mm", run.q[:, k] * 1e3, "%.8f") for k, a in enumerate("xyz")]
        columns += [("pass", run.turn, "%d"), ("direction", run.direction, "%d"),
                    ("feed_mm_min", run.feed * 60e3, "%.3f")]
        gaps, angles = self.readings(run)
        columns += [(n, gaps[:, k] * 1e6, "%.6f") for k, n in enumerate(PROBES) if gaps is not None]
        columns += [(n, angles[:, k], "%.10f") for k, n in enumerate(PIVOTS) if angles is not None]
        if run.kind == "length":
            columns += [("length_mm", self.lengths(run) * 1e3, "%.8f"), ("u_length_um", 0.1 + 0 * run.t, "%g")]
        columns += [(f"temp_{n}_c", run.temps[:, k], "%.5f") for k, n in enumerate(("column", "table"))]
        columns += [(name, value, "%.4f") for name, value in self.hook("columns", run, otherwise={}).items()]
        columns += [("flags", 0 * run.t, "%d")]
        began = datetime.datetime(2026, 11, 21, 8) + datetime.timedelta(seconds=run.start)
        header = ["abbe-recording = 1", f'kind = "{run.kind}"', f'machine = "{self.settings["name"]}"',
                  f"started = {began.isoformat(timespec='milliseconds')}Z", *run.header]
        path = folder / f"{run.name}.csv"
        with path.open("w", encoding="utf-8") as out:
            out.writelines(f"# {line}\n" for line in header)
            out.write(",".join(name for name, _, _ in columns) + "\n")
            np.savetxt(out, np.stack([v for _, v, _ in columns], axis=1), [f for _, _, f in columns], ",")
        return path

    def write_all(self, folder, kinds=None):
        return [self.write(run, folder) for run in self.runs if kinds is None or run.kind in kinds]


def changes(world, plain):
    """How far the effect moves the readings of each run, in standard deviations of the stated noise: the root of
    the sum of squares over all readings, each channel less its mean, before any parameter is fitted."""
    noise = world.settings["noise"]["probe_nm"] * 1e-9, world.settings["linkage"]["noise"]["encoder_urad"] * 1e-6
    found = {}
    for run in world.runs:
        total = 0.0
        if run.kind == "length":
            total = (((world.lengths(run) - plain.lengths(run)) / 1e-7) ** 2).sum()
        for with_it, without, sigma in zip(world.readings(run), plain.readings(run), noise):
            if with_it is not None:
                change = (with_it - without) / sigma
                total += ((change - change.mean(axis=0)) ** 2).sum()
        found[run.name] = float(np.sqrt(total))
    return found
