"""Which runs are made, and where the axes stand in each row: paths, times, temperatures, headers.

The plan is that of a reduced standard campaign: sweeps of X, Y and Z in both directions, circles in three
planes in both senses at two feeds, stays at points all over the travels, a standstill, a line of lengths.
`wide` adds gap steps beside each sweep and, with the target mounted a second time, a sweep of each axis.
"""
import dataclasses

import numpy as np

FEED = 600 / 60e3  # m/s
STATIONS = np.arange(0, 0.0601, 0.004)


@dataclasses.dataclass
class Run:
    name: str
    kind: str
    axis: str  # the swept axis, the plane of a circle, or ""
    start: float  # s since the campaign began
    t: np.ndarray  # s since `start`
    q: np.ndarray  # (n, 3) true positions of the axes, m
    sense: np.ndarray  # (n, 3) sign of the last motion of each axis
    since: np.ndarray  # (n, 3) way since its last reversal, m
    speed: np.ndarray  # (n, 3) m/s
    turn: np.ndarray  # pass
    direction: np.ndarray
    feed: np.ndarray  # m/s
    header: list
    mounting: str = "first"  # of the target
    number: int = 0
    temps: np.ndarray = None  # (n, 2) column and table, degC

    @property
    def clock(self):
        return self.start + self.t

    @property
    def probes(self):
        return self.kind in ("sweep", "dwell", "gap-steps")

    @property
    def pivots(self):
        return self.kind in ("linkage", "dwell")


def history(q):
    """Sense of the last motion and way since the last reversal, of each axis, along places (n, 3). All axes have
    come from afar."""
    sense, since = np.ones(q.shape), np.ones(q.shape)
    for i in range(1, len(q)):
        step = q[i] - q[i - 1]
        way = np.where(step == 0, sense[i - 1], np.sign(step))
        sense[i] = way
        since[i] = np.where(way == sense[i - 1], since[i - 1], 0) + np.abs(step)
    return sense, since


def stays(draw, places, rows, settle, keep=None):
    """Rows at standstill at each of the places (n, 3), some 20 a second and never quite even; moving between
    them is not recorded."""
    period = draw.uniform(0.040, 0.055)
    places = np.asarray(places, float)
    keep = np.ones(len(places), bool) if keep is None else keep
    sense, since = history(places)
    clock, times, index = 0.0, [], []
    for i, place in enumerate(places):
        if i:
            clock += np.linalg.norm(place - places[i - 1]) / FEED + settle
        if keep[i]:
            times.append(clock + period * np.arange(rows) + draw.uniform(0, 1e-3, rows))
            index.append(np.full(rows, i))
            clock += period * rows
    index = np.concatenate(index)
    return np.concatenate(times), places[index], sense[index], since[index], index


def sweep(draw, axis, start, passes=5, mounting="first", head="0deg"):
    k = "XYZ".index(axis)
    there = [*STATIONS, STATIONS[-1] + 5e-4]
    back = [*STATIONS[::-1], STATIONS[0] - 5e-4]
    line = np.array([STATIONS[-1], STATIONS[0] - 5e-4] + (there + back) * passes)  # it turns before the first one too
    places = np.zeros((len(line), 3))
    places[:, k] = line
    on = np.isin(line, STATIONS) & (np.arange(len(line)) > 1)
    t, q, sense, since, index = stays(draw, places, 13, 0.02, on)
    number = (index - 2) // (2 * len(there)) + 1
    header = [f'axis = "{axis}"', "[sweep]", "window_um = 20", "settle_s = 0.1", "[mounting]",
              f'id = "{mounting}"', f'head = "{head}"', "target_shift_mm = 0.0", "target_reversed = false"]
    n = len(t)
    return Run(f"sweep_{axis}" + ("_again" if mounting != "first" else ""), "sweep", axis, start, t, q, sense, since,
               np.zeros((n, 3)), number, sense[:, k], np.full(n, FEED), header, mounting)


def gap_steps(draw, axis, start):
    """At three places of the swept axis each of the other two steps to 45 um on both sides and back."""
    k = "XYZ".index(axis)
    places, number = [], []
    for place, at in enumerate(STATIONS[[0, len(STATIONS) // 2, -1]]):
        for other in range(3):
            for step in (0, 45e-6, 0, -45e-6, 0) if other != k else ():
                places.append(np.eye(3)[k] * at + np.eye(3)[other] * step)
                number.append(place + 1)
    t, q, sense, since, index = stays(draw, places, 13, 0.6)
    header = [f'axis = "{axis}"', "[mounting]", 'id = "first"', 'head = "0deg"', "target_shift_mm = 0.0",
              "target_reversed = false"]
    n = len(t)
    moves = np.diff(np.vstack([places[:1], places]), axis=0)
    last = np.where(moves.any(axis=1), np.sign(moves.sum(axis=1)), 1.0)
    return Run(f"gap_steps_{axis}", "gap-steps", axis, start, t, q, sense, since, np.zeros((n, 3)),
               np.array(number)[index], last[index], np.full(n, FEED), header)


def circle(plane, feed, start, radius=0.020):
    """Counter-clockwise in the plane, then clockwise, rows about every 2 degrees."""
    i, j = ("XYZ".index(a) for a in plane)
    count = 190
    parts, clock = [], 0.0
    for way in (1, -1):
        angle = way * np.linspace(-0.2, 2 * np.pi, count + 12)
        t = clock + (angle * way + 0.2) * radius / feed
        q = np.full((len(t), 3), 0.030)
        q[:, i] += radius * np.cos(angle)
        q[:, j] += radius * np.sin(angle)
        v = np.zeros((len(t), 3))
        v[:, i], v[:, j] = -way * feed * np.sin(angle), way * feed * np.cos(angle)
        since = np.ones((len(t), 3))  # all axes have come from afar
        for axis, top in ((i, 0.0), (j, np.pi / 2)):  # where it turns, and each half turn later
            turned = np.floor((angle * way - top) / np.pi - 1e-9) * np.pi + top  # not where it just arrives
            way_since = radius * np.abs(1 - np.cos(angle * way - turned))
            since[:, axis] = np.where(turned >= -0.2, way_since, 1.0)
        parts.append((t, q, v, np.full(len(t), way), since))
        clock = t[-1] + 4.0
    t, q, v, way, since = (np.concatenate(p) for p in zip(*parts))
    sense = np.where(v == 0, 1.0, np.sign(v))
    keep = np.concatenate([np.arange(count + 12) >= 12] * 2)
    header = ['course = "circle"', f'axis = "{plane}"', f"radius_mm = {radius * 1e3}", 'elbow = "up"',
              "[mounting]", 'base = "first"']
    n = keep.sum()
    return Run(f"circle_{plane}_{feed * 60e3:.0f}", "linkage", plane, start, t[keep], q[keep], sense[keep],
               since[keep], v[keep], np.ones(n, int), way[keep], np.full(n, feed), header)


def space(draw, start, points=5, rows=6):
    """Stays at points all over the travels, row by row and back, each a little off its grid."""
    grid = np.linspace(0.0015, 0.0585, points)
    places = [(grid[x if y % 2 == 0 else -1 - x], grid[y if z % 2 == 0 else -1 - y], grid[z])
              for z in range(points) for y in range(points) for x in range(points)]
    places = np.array(places) + draw.uniform(-1e-3, 1e-3, (len(places), 3))
    t, q, sense, since, index = stays(draw, places, rows, 0.1)
    header = ['course = "cube"', 'elbow = "up"', "[mounting]", 'base = "first"']
    n = len(t)
    return Run("space", "linkage", "", start, t, q, sense, since, np.zeros((n, 3)), np.ones(n, int),
               sense[:, 0], np.full(n, FEED), header)


def standstill(draw, start):
    t = 0.09 * np.arange(600) + draw.uniform(0, 1e-3, 600)
    n = len(t)
    header = ['axis = "X"', 'elbow = "up"', "[mounting]", 'id = "first"', 'head = "0deg"',
              "target_shift_mm = 0.0", "target_reversed = false", 'base = "first"']
    return Run("dwell", "dwell", "X", start, t, np.zeros((n, 3)), np.ones((n, 3)), np.ones((n, 3)),
               np.zeros((n, 3)), np.ones(n, int), np.zeros(n), np.zeros(n), header)


def length(draw, axis, start):
    k = "XYZ".index(axis)
    places = np.full((13, 3), 0.030)
    places[:, k] = np.linspace(0, 0.060, 13)
    t, q, sense, since, _ = stays(draw, places, 1, 1.0)
    n = len(t)
    return Run(f"length_{axis}", "length", axis, start, t, q, sense, since, np.zeros((n, 3)),
               np.ones(n, int), sense[:, k], np.full(n, FEED), ["u_scale_ppm = 2"])


class Weather:
    """Temperatures of column and table: slow waves about 20 degC, 0.1 degC rms."""

    def __init__(self, draw):
        self.period = draw.uniform(400, 6000, (2, 5))
        self.phase, self.share = draw.uniform(0, 2 * np.pi, (2, 5)), draw.normal(size=(2, 5))
        self.share *= 0.1 * np.sqrt(2) / np.linalg.norm(self.share, axis=1)[:, None]

    def __call__(self, clock):
        angle = 2 * np.pi * clock[:, None, None] / self.period + self.phase
        return 20 + (self.share * np.sin(angle)).sum(axis=2)


def plan(draw, wide=False):
    """The runs of a campaign in their order, one after the other with pauses."""
    makers = [lambda s, a=a: sweep(draw, a, s) for a in "XYZ"]
    makers += [lambda s, p=p, f=f: circle(p, f / 60e3, s) for p in ("XY", "YZ", "ZX") for f in (600, 120)]
    makers += [lambda s: space(draw, s), lambda s: standstill(draw, s), lambda s: length(draw, "X", s)]
    if wide:
        makers += [lambda s, a=a: gap_steps(draw, a, s) for a in "XYZ"]
        makers += [lambda s, a=a: sweep(draw, a, s, 2, "second") for a in "XYZ"]
    runs, clock, weather = [], 0.0, Weather(draw)
    for number, make in enumerate(makers):
        run = make(clock)
        run.number, run.name = number, f"{number + 1:02d}_{run.name}"
        run.temps = weather(run.clock)
        clock = run.clock[-1] + draw.uniform(20, 200)
        runs.append(run)
    return runs
