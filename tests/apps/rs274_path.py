"""What LinuxCNC's interpreter makes of a program: its canonical calls as a path of the axes.

Independent of abbe: the offsets of the calls are added here (LinuxCNC 2.9, emccanon.cc: G92, the turn in XY, the
coordinate system, the tool), arcs are sampled here.
"""
import dataclasses
import os
import re
import subprocess

import numpy as np

CALL = re.compile(r"^\s*\d+\s+N\S*\s+(\w+)\((.*)\)\s*$")
PLANES = {"CANON_PLANE_XY": (0, 1, 2), "CANON_PLANE_XZ": (2, 0, 1), "CANON_PLANE_YZ": (1, 2, 0),
          "1": (0, 1, 2), "3": (2, 0, 1), "2": (1, 2, 0)}


@dataclasses.dataclass
class Move:
    kind: str             # "rapid" or "feed"
    line: np.ndarray      # points of the axes, mm; the first is the start
    tool: np.ndarray      # offset of the tool, mm
    digit: float          # mm, of what rs274 prints
    turns: float = 0.0    # rad, of an arc
    rotary: tuple = ()    # A, B, C at the end, deg


class Canon:
    """Follows the calls. Lengths are printed in the unit that is in force."""

    def __init__(self):
        self.unit, self.g5x, self.g92, self.angle = 1.0, np.zeros(3), np.zeros(3), 0.0
        self.tool, self.at, self.plane = np.zeros(3), np.zeros(3), (0, 1, 2)
        self.moves, self.others, self.probes = [], [], 0

    def machine(self, p):
        p = np.atleast_2d(p) + self.g92
        c, s = np.cos(self.angle), np.sin(self.angle)
        turned = np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]], axis=1)
        return turned + self.g5x + self.tool

    def add(self, kind, points, turns=0.0, rotary=()):
        line = np.vstack([self.at, self.machine(points)])
        self.moves.append(Move(kind, line, self.tool.copy(), self.unit * 1e-4, turns, rotary))
        self.at = line[-1]

    def program(self):
        """The axes in program coordinates."""
        p = self.at - self.tool - self.g5x
        c, s = np.cos(self.angle), -np.sin(self.angle)
        return np.array([c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]]) - self.g92

    def arc(self, numbers):
        first_end, second_end, first_axis, second_axis, rotation, end = numbers[:6]
        u, v, w = self.plane
        start = self.program()
        centre = self.unit * np.array([first_axis, second_axis])
        stop = np.zeros(3)
        stop[u], stop[v], stop[w] = self.unit * first_end, self.unit * second_end, self.unit * end
        a, b = np.array([start[u], start[v]]) - centre, np.array([stop[u], stop[v]]) - centre
        begin, turn = np.arctan2(a[1], a[0]), np.arctan2(b[1], b[0])
        sweep = turn - begin
        near = self.unit * 2e-4 / max(np.linalg.norm(a), 1e-9)  # what is printed cannot tell them apart
        if rotation > 0:
            while sweep <= near:
                sweep += 2 * np.pi
            sweep += 2 * np.pi * (rotation - 1)
        else:
            while sweep >= -near:
                sweep -= 2 * np.pi
            sweep += 2 * np.pi * (rotation + 1)
        radius = max(np.linalg.norm(a), np.linalg.norm(b))
        count = max(2, int(np.ceil(abs(sweep) / np.sqrt(8 * 2e-4 / max(radius, 1e-3)))))
        part = np.linspace(0, 1, count + 1)[1:, None]
        angle = begin + part * sweep
        r = np.linalg.norm(a) + part * (np.linalg.norm(b) - np.linalg.norm(a))
        points = np.zeros((count, 3))
        points[:, [u]], points[:, [v]] = centre[0] + r * np.cos(angle), centre[1] + r * np.sin(angle)
        points[:, [w]] = start[w] + part * (stop[w] - start[w])
        points[-1] = stop
        self.add("feed", points, sweep, numbers[6:9])

    def take(self, name, text):
        if name == "USE_LENGTH_UNITS":
            self.unit = 25.4 if "INCH" in text else 1.0
            return
        if name == "SELECT_PLANE":
            self.plane = PLANES[text.strip()]
        numbers = [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", text)]
        if name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            self.add("rapid" if name == "STRAIGHT_TRAVERSE" else "feed", self.unit * np.array(numbers[:3]),
                     rotary=numbers[3:6])
        elif name == "ARC_FEED":
            self.arc(numbers)
        elif name == "SET_G5X_OFFSET":
            self.g5x = self.unit * np.array(numbers[1:4])
        elif name == "SET_G92_OFFSET":
            self.g92 = self.unit * np.array(numbers[:3])
        elif name == "SET_XY_ROTATION":
            self.angle = np.radians(numbers[0])
        elif name == "USE_TOOL_LENGTH_OFFSET":
            self.tool = self.unit * np.array(numbers[:3])
        elif name in ("STRAIGHT_PROBE", "RIGID_TAP", "NURBS_FEED"):
            self.probes += 1
        elif name in ("DWELL", "START_SPINDLE_CLOCKWISE", "START_SPINDLE_COUNTERCLOCKWISE", "STOP_SPINDLE_TURNING",
                      "SET_SPINDLE_SPEED", "SET_FEED_RATE", "CHANGE_TOOL", "SELECT_TOOL", "FLOOD_ON", "FLOOD_OFF",
                      "MIST_ON", "MIST_OFF", "PROGRAM_STOP", "OPTIONAL_PROGRAM_STOP", "MESSAGE"):
            self.others.append((name, text))


def canonical(program, folder, *options, timeout=30):
    """Canon of a program, and what rs274 complains of (empty: nothing)."""
    done = subprocess.run(["rs274", "-g", *options, str(program)], capture_output=True, text=True, errors="replace",
                          stdin=subprocess.DEVNULL, env={**os.environ, "HOME": str(folder)}, cwd=folder,
                          timeout=timeout)
    canon = Canon()
    for line in done.stdout.splitlines():
        found = CALL.match(line)
        if found:
            canon.take(*found.groups())
    complaint = " ".join(line for line in done.stderr.splitlines() if line != "executing")
    return canon, complaint if done.returncode != 0 or complaint else ""


def distances(point_rows, line):
    """Of points to a polyline, mm."""
    a, b = line[:-1], line[1:]
    along = b - a
    square = np.maximum((along ** 2).sum(axis=1), 1e-30)
    part = np.clip(((point_rows[:, None] - a) * along).sum(axis=2) / square, 0.0, 1.0)
    return np.linalg.norm(point_rows[:, None] - (a + part[..., None] * along), axis=2).min(axis=1)


def follows(asked, commanded, made, tolerance_mm):
    """Nothing if the places `made` (rows) by the moves `commanded` go along the moves `asked` in order, each end made
    and nothing beside; what is wrong otherwise."""
    at = 0
    for number, move in enumerate(asked):
        tolerance = tolerance_mm + 2.0 * move.digit
        end, begin = move.line[-1], at
        is_still = move.line.ptp(axis=0).max() == 0.0  # "G0" alone: the control moves to where it is
        while True:
            if at == len(made):
                return f"move {number} to {end} is not made"
            is_there = np.abs(made[at] - end).max() <= tolerance
            if is_still and not (is_there and commanded[at].kind == move.kind):
                at += commanded[at].line.ptp(axis=0).max() == 0.0  # of the uncorrected start
                break
            if commanded[at].kind != move.kind:
                return f"move {number} to {end}: a {commanded[at].kind} instead of a {move.kind}"
            at += 1
            # The end of a full circle is its start: at least a point for every third of a turn.
            is_short = abs(move.turns) < 6.0 or move.line.ptp(axis=0).max() < 10 * tolerance
            if is_there and (is_short or at - begin >= abs(move.turns) / 2.1):
                break
        if is_still:
            continue
        if not np.allclose(commanded[at - 1].rotary, move.rotary, atol=2e-4):
            return f"move {number} to {end}: A, B, C {commanded[at - 1].rotary} instead of {move.rotary}"
        away = distances(made[begin:at], move.line).max()
        if away > tolerance:
            return f"move {number} to {end}: {1e3 * away:.1f} um beside the path"
    if at != len(made):
        return f"{len(made) - at} moves that the program does not make"
    return ""
