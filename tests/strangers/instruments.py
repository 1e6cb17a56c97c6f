"""The five-probe head before its target, and the linkage with its ball: exact geometry, own equations.

Frames as in docs/theory-head.md and docs/theory-linkage.md; no small angle anywhere. SI units.
"""
import copy

import numpy as np

from machine import apply, inverse, joined, turn

FACES = {"z": np.array([0, 0, 1.0]), "y": np.array([0, 1.0, 0]), "-x": np.array([-1.0, 0, 0])}
UNIT = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "-x": [-1, 0, 0], "-y": [0, -1, 0], "-z": [0, 0, -1]}


class Face:
    """One face of the target: turned a little, and not flat; waves of random direction and length."""

    def __init__(self, draw, normal, tilt, form, length):
        self.flat, self.normal = normal, turn(tilt)[0] @ normal
        across = [np.array(UNIT[e], float) for e in "xyz" if abs(np.dot(UNIT[e], normal)) < 0.5]
        self.directions = draw.normal(size=(24, 2)) @ np.array(across) / length
        self.phases = draw.uniform(0, 2 * np.pi, 24)
        self.amount = form * np.sqrt(2 / 24)

    def height(self, p):
        return self.amount * np.cos(p @ self.directions.T + self.phases).sum(axis=-1)


class Target:
    def __init__(self, draw, settings, form_factor=1.0):
        form, length = settings["form_nm"] * 1e-9 * form_factor, settings["form_length_mm"] * 1e-3
        mounted = draw.uniform(-1e-4, 1e-4, 3)
        a, b, c = settings["u_squareness_urad"] * 1e-6 * draw.normal(size=3)
        self.lean = {"z": (0, 0, 0), "y": (a, 0, 0), "-x": (0, b, c)}
        self.faces = {name: Face(draw, n, mounted + self.lean[name], form, length) for name, n in FACES.items()}

    def mounted_again(self, draw):
        """The same target, tilted otherwise."""
        other, mounted = copy.copy(self), draw.uniform(-1e-4, 1e-4, 3)
        other.faces = {name: copy.copy(face) for name, face in self.faces.items()}
        for name, face in other.faces.items():
            face.normal = turn(mounted + self.lean[name])[0] @ face.flat
        return other


class Head:
    """Five measuring lines, one head for all sweeps; `zero` are the gaps that the fitter set."""

    def __init__(self, draw, settings):
        tolerance = settings["tolerance"]
        self.frame = {a: np.array([UNIT[w] for w in settings[f"axis_{a}"]["rotation"]], float).T for a in "XYZ"}
        self.names = {a: settings[f"axis_{a}"]["rotation"] for a in "XYZ"}
        self.origin = {a: np.array(settings[f"axis_{a}"]["position_mm"]) * 1e-3 for a in "XYZ"}
        point, along = np.zeros((5, 3)), np.zeros((5, 3))
        for k, p in enumerate("abcde"):
            face = 2 if k < 3 else 1
            u, other = np.array(settings[f"probe_{p}"]["position_mm"]) * 1e-3 + \
                tolerance["probe_position_um"] * 1e-6 * draw.normal(size=2)
            point[k, 0], point[k, 3 - face], along[k, face] = u, other, 1.0
        misaligned = turn(tolerance["installation_urad"] * 1e-6 * draw.normal(size=3))[0]
        self.point = point @ misaligned.T + tolerance["installation_um"] * 1e-6 * draw.normal(size=3)
        self.along = along @ misaligned.T
        self.gain = 1 + tolerance["gain_ppm"] * 1e-6 * draw.normal(size=5)
        self.zero = {a: 1e-4 + 1e-5 * draw.normal(size=5) for a in "XYZ"}

    def met(self, axis, R, p, target):
        """How far along its line each probe's face stands, (n, 5) in m; (R, p): the tool in the workpiece."""
        origin, frame = self.origin[axis], self.frame[axis]
        way = np.empty((len(R), 5))
        for k in range(5):
            face = target.faces[self.names[axis][2 if k < 3 else 1]]
            start = apply(R, origin + frame @ self.point[k]) + p - origin
            along = apply(R, frame @ self.along[k])
            slope = along @ face.normal
            way[:, k] = -(start @ face.normal) / slope
            for _ in range(3):  # the face is not flat
                place = start + way[:, k, None] * along
                way[:, k] -= (place @ face.normal - face.height(place)) / slope
        return way

    def gaps(self, axis, work, tool, target):
        """Gaps (n, 5) in m while the head of that axis sees the target; poses from the bed."""
        here = self.met(axis, *joined(inverse(work), tool), target)
        gap = self.zero[axis] - here + self.met(axis, np.eye(3)[None], np.zeros((1, 3)), target)
        return self.gain * (gap - 1e-4) + 1e-4


class Linkage:
    """Pivot 1 about z, pivots 2 and 3 about y; every axis leans and stands off, every length is off."""

    def __init__(self, draw, settings):
        t, unit = settings["tolerance"], 1e-6
        off = lambda key, *shape: t[key] * unit * draw.normal(size=shape)
        self.length = np.array([settings["link_1_mm"], settings["link_2_mm"]]) * 1e-3 + off("link_um", 2)
        self.nominal = np.array([settings["link_1_mm"], settings["link_2_mm"]]) * 1e-3
        self.lean, self.shift = off("pivot_urad", 3, 2), off("pivot_um", 3, 2)
        self.offset, self.once = off("encoder_offset_urad", 3), off("eccentricity_urad", 3, 2)
        self.graduation, self.bearing = off("graduation_urad", 3, 2, 2), off("bearing_um", 3, 2, 2, 2)
        self.orders = settings["graduation_harmonics"], settings["bearing_harmonics"]
        self.compliance, self.ball = off("compliance_urad", 3), off("ball_um", 3)
        self.expansion = settings["expansion_ppm_per_c"] * unit + off("thermal_ppm_per_c", 2)
        base = settings["base"]["position_mm"]
        self.base = turn(off("base_urad", 3)), (np.array(base) * 1e-3 + off("base_um", 3))[None]
        self.nominal_base, self.warm_from = np.array(base) * 1e-3, settings["reference_c"]

    def tip(self, angles, warmth):
        """The ball in the base frame at encoder angles (n, 3)."""
        n = len(angles)
        true = angles + self.offset + self.once[:, 0] * np.sin(angles) + self.once[:, 1] * np.cos(angles)
        for j, order in enumerate(self.orders[0]):
            true = true + self.graduation[:, j, 0] * np.sin(order * angles) + \
                self.graduation[:, j, 1] * np.cos(order * angles)
        # The link that a pivot carries bends it most where it is level: cosine of its slope.
        slope_1, slope_2 = true[:, 1], true[:, 1] + true[:, 2] - np.pi / 2
        true[:, 1] += self.compliance[1] * np.cos(slope_1)
        true[:, 2] += self.compliance[2] * np.cos(slope_2)
        frame = np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3))
        grown = self.length * (1 + self.expansion * warmth[:, None])
        across = [(0, 1), (0, 2), (0, 2)]
        for i in range(3):
            lean, shift, spin = np.zeros(3), np.zeros((n, 3)), np.zeros((n, 3))
            lean[list(across[i])] = self.lean[i]
            for side, k in enumerate(across[i]):
                shift[:, k] = self.shift[i, side]
                for j, order in enumerate(self.orders[1]):
                    shift[:, k] += self.bearing[i, side, j, 0] * np.sin(order * angles[:, i]) + \
                        self.bearing[i, side, j, 1] * np.cos(order * angles[:, i])
            if i == 2:
                shift[:, 0] += grown[:, 0]
            spin[:, 2 if i == 0 else 1] = true[:, i]
            frame = joined(frame, (turn(lean) @ turn(spin), shift))
        last = np.stack([np.full(n, self.ball[0]), np.full(n, self.ball[1]), grown[:, 1]], axis=1)
        return frame[1] + apply(frame[0], last)

    def first_guess(self, p):
        """Angles of the perfect linkage, elbow up."""
        L1, L2 = self.nominal
        r = np.hypot(p[:, 0], p[:, 1])
        s3 = (r**2 + p[:, 2] ** 2 - L1**2 - L2**2) / (2 * L1 * L2)
        c3 = -np.sqrt(1 - s3**2)
        a, b = L1 + L2 * s3, L2 * c3
        return np.stack([np.arctan2(p[:, 1], p[:, 0]),
                         np.arctan2(b * r - a * p[:, 2], a * r + b * p[:, 2]), np.arctan2(s3, c3)], axis=1)

    def angles(self, work, tool, temperature, ball=0.0):
        """Encoder angles (n, 3) while the ball follows the tool point, by Newton's method; `ball` (n, 3) in m:
        how far it stands off in its cap."""
        warmth = temperature - self.warm_from
        X_MB = joined(work, self.base)
        R, p = inverse(X_MB)
        wanted = p + apply(R, tool[1] + apply(tool[0], ball))
        q = self.first_guess(wanted)
        for _ in range(8):
            miss = wanted - self.tip(q, warmth)
            if np.abs(miss).max() < 1e-12:
                break
            J = np.stack([(self.tip(q + h, warmth) - self.tip(q - h, warmth)) / 2e-6
                          for h in 1e-6 * np.eye(3)], axis=2)
            q = q + np.linalg.solve(J, miss[:, :, None])[:, :, 0]
        assert np.abs(miss).max() < 1e-10, "the linkage does not reach its ball"
        return np.unwrap(q, axis=0)
