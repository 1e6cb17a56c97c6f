"""A machine with errors and its map file, written and evaluated without abbe: NumPy only.

The errors are Chebyshev series, which abbe calls the form "polynomial"; the gauge (zero at the first
end, no least-squares slope in a straightness) and the chain of full rotations are computed here anew.
"""
import numpy as np
from numpy.polynomial import chebyshev, legendre

TRAVEL = 0.060
MOTIONS = [f"E{motion}{axis}" for axis in "XYZ" for motion in "XYZABC"]


def rotation(vector):
    """exp of a rotation vector, by the series of its matrix."""
    skew = np.array([[0, -vector[2], vector[1]], [vector[2], 0, -vector[0]], [-vector[1], vector[0], 0]])
    result, term = np.eye(3), np.eye(3)
    for n in range(1, 12):
        term = term @ skew / n
        result = result + term
    return result


def pose(R, p):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, p
    return X


class MapMachine:
    """`positive`: how X, Y and Z count, as the map file says it: "carriage", "tool", or one word each.
    An axis that carries the workpiece and counts as the tool goes has its carriage at minus its number;
    its positioning error is counted along the number, its other errors along the machine."""

    def __init__(self, seed, chain="[w X Y b Z t]", tool=(0.010, -0.020, -0.080), degree=5, size=1.0,
                 positive="carriage", travel=(0.0, TRAVEL)):
        draw = np.random.default_rng(seed)
        self.chain, self.tool, self.degree, self.travel = chain, np.array(tool), degree, travel
        self.series = {name: size * (2e-6 if name[1] in "XYZ" else 2e-5) * draw.normal(size=degree + 1)
                       for name in MOTIONS}
        self.squareness = size * 3e-5 * draw.normal(size=3)  # A0Z B0Z C0Y
        work, tool_side = chain[2:-2].replace(" ", "").split("b")
        self.from_bed = {"work": work[::-1], "tool": tool_side}
        words = positive.split() * (3 if " " not in positive else 1)
        self.positive = positive
        self.sense = np.array([-1.0 if axis in work and word == "tool" else 1.0 for axis, word in zip("XYZ", words)])
        self.signs = self.sense * np.array([-1.0 if axis in work else 1.0 for axis in "XYZ"])

    def motion(self, name, q):
        first, last = self.travel
        u = (np.asarray(q) - first) * 2 / (last - first) - 1
        series = self.series[name]
        value = chebyshev.chebval(u, series) - chebyshev.chebval(-1.0, series)
        if name[1] in "XYZ" and name[1] != name[2]:
            points, weights = legendre.leggauss(20)
            slope = 1.5 * np.sum(weights * points * chebyshev.chebval(points, series))
            value = value - slope * (u + 1)
        return value

    def body(self, axes, q):
        a0z, b0z, c0y = self.squareness
        turn = {"X": (0, 0, 0), "Y": (0, 0, c0y), "Z": (a0z, b0z, 0)}
        X = np.eye(4)
        for axis in axes:
            k = "XYZ".index(axis)
            errors = [self.motion(f"E{m}{axis}", q[k]) for m in "XYZABC"]
            line = rotation(turn[axis])[:, k]
            errors[k] *= self.sense[k]
            X = X @ pose(rotation(errors[3:]), self.sense[k] * q[k] * line + errors[:3])
        return X

    def error(self, q, tool=None):
        """Of the tool in the workpiece, m; q in m."""
        Q = np.append(self.tool if tool is None else tool, 1.0)
        actual = np.linalg.solve(self.body(self.from_bed["work"], q), self.body(self.from_bed["tool"], q) @ Q)
        return actual[:3] - (Q[:3] + self.signs * np.asarray(q))

    def bodies(self, axes, q):
        """body() for many positions at once; rotations by the formula of Rodrigues."""
        a0z, b0z, c0y = self.squareness
        turn = {"X": (0, 0, 0), "Y": (0, 0, c0y), "Z": (a0z, b0z, 0)}
        R, p = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        for axis in axes:
            k = "XYZ".index(axis)
            errors = np.stack([self.motion(f"E{m}{axis}", q[:, k]) for m in "XYZABC"], axis=1)
            errors[:, k] *= self.sense[k]
            step = self.sense[k] * q[:, k, None] * rotation(turn[axis])[:, k] + errors[:, :3]
            p = p + np.einsum("nij,nj->ni", R, step)
            angle = np.maximum(np.linalg.norm(errors[:, 3:], axis=1), 1e-30)
            x, y, z = (errors[:, 3:] / angle[:, None]).T
            zero = np.zeros_like(x)
            skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
            turned = (np.eye(3) + np.sin(angle)[:, None, None] * skew
                      + (1 - np.cos(angle))[:, None, None] * skew @ skew)
            R = R @ turned
        return R, p

    def made_many(self, q, tools):
        """made() for many positions (rows) and tools."""
        R_w, p_w = self.bodies(self.from_bed["work"], q)
        R_t, p_t = self.bodies(self.from_bed["tool"], q)
        tip = np.einsum("nij,nj->ni", R_t, tools) + p_t
        actual = np.einsum("nji,nj->ni", R_w, tip - p_w)
        return q + self.signs * (actual - (tools + self.signs * q))

    def made(self, q, tool=None):
        """Where the axes would have to stand on a perfect machine for the tool to be where it is."""
        return np.asarray(q) + self.signs * self.error(q, tool)

    def write(self, path, relative=0.1):
        def floats(values):
            return "[" + ", ".join(repr(float(v)) for v in values) + "]"
        lines = ["format = 1", 'machine = "numpy-mill"', f'chain = "{self.chain}"',
                 f'positive = "{self.positive}"', "reference = [0.0, 0.0, 0.0]",
                 f"tool = {floats(self.tool)}", "temperature_c = 20.0", 'scale = "calibrated"',
                 f"squareness = {floats(self.squareness)}", 'squareness_from = ["linkage", "linkage", "linkage"]',
                 "[travel]"] + [f"{k} = {floats(self.travel)}" for k in "xyz"]
        names, sizes = [], []
        for name in MOTIONS:
            lines += ["[[error]]", f'name = "{name}"', 'from = "sweep"', 'form = "polynomial"',
                      f"degree = [{self.degree}.0]", f"interval_m = {floats(self.travel)}",
                      f"coefficients = {floats(self.series[name])}"]
            names += [f"{name}.c{i}" for i in range(self.degree + 1)]
            sizes += [relative * (2e-6 if name[1] in "XYZ" else 2e-5)] * (self.degree + 1)
        names += [f"squareness.{name}" for name in ("A0Z", "B0Z", "C0Y")]
        sizes += [relative * 3e-5] * 3
        rows = [0.0 if i != j else sizes[i] ** 2 for i in range(len(sizes)) for j in range(i + 1)]
        lines += ["[covariance]", "names = [" + ", ".join(f'"{n}"' for n in names) + "]", f"rows = {floats(rows)}"]
        path.write_text("\n".join(lines) + "\n")
        return path
