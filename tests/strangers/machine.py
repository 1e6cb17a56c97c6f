"""A machine whose 21 errors no Gaussian process has drawn. SI units, angles in rad.

Each error function is a sum of a few sinusoids, a bow and a rounded kink, as smooth and as large as the
machine file says; where asked, rougher, larger, with a sharp kink or with sizes of a heavy tail. Its gauge is
that of docs/theory-volumetric.md: zero at the first end of the travel, a straightness without its
least-squares line, the squarenesses beside it.
"""
import numpy as np

TRAVEL = 0.060
AXES = "XYZ"
MOTIONS = ["EX", "EY", "EZ", "EA", "EB", "EC"]


def turn(vector):
    """Rotations (n, 3, 3) of rotation vectors (n, 3), by Rodrigues' formula."""
    v = np.atleast_2d(np.asarray(vector, float))
    angle = np.linalg.norm(v, axis=1)[:, None, None]
    K = np.zeros((len(v), 3, 3))
    K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    K -= K.transpose(0, 2, 1)
    safe = np.where(angle > 0, angle, 1.0)
    first = np.where(angle > 0, np.sin(safe) / safe, 1.0)
    second = np.where(angle > 0, 2 * np.sin(safe / 2) ** 2 / safe**2, 0.5)
    return np.eye(3) + first * K + second * K @ K


def apply(R, p):
    """Row by row R p."""
    return np.einsum("nij,nj->ni", R, np.broadcast_to(p, (len(R), 3)))


def joined(first, second):
    """The pose of a frame seen through another one: both are (R, p)."""
    return first[0] @ second[0], first[1] + apply(first[0], second[1])


def inverse(pose):
    R = pose[0].transpose(0, 2, 1)
    return R, -apply(R, pose[1])


class Shape:
    """One function of the position with an rms of 1 over the travel, and nothing finer than about `length`."""

    def __init__(self, draw, length, sharp=False):
        count = draw.integers(1, 6)
        stretch = draw.uniform(1.0, 2.5, count)  # several scales, from `length` upwards
        self.waves = np.array([draw.normal(size=count), draw.uniform(0.3, 1.2, count) / (length * stretch),
                               draw.uniform(0, 2 * np.pi, count)])
        self.bow = draw.normal(size=3) * [0.5, 0.5, 0.1] * draw.choice([0.0, 1.0])
        self.kink = (draw.normal() * draw.choice([0.0, 1.0]) + 1.5 * sharp, draw.uniform(0.2, 0.8) * TRAVEL,
                     2e-4 if sharp else 2 * length)
        self.offset, self.size = 0.0, 1.0
        value = self(np.linspace(0, TRAVEL, 200))
        self.offset, self.size = value.mean(), value.std()

    def __call__(self, q):
        q = np.asarray(q, float)
        amount, rate, phase = self.waves
        value = np.sum(amount * np.sin(q[..., None] * rate + phase), axis=-1)
        value = value + np.polynomial.legendre.legval(2 * q / TRAVEL - 1, [0.0, *self.bow])
        bend, place, radius = self.kink
        value = value + bend * np.sqrt((q - place) ** 2 + radius**2) / 0.02
        return (value - self.offset) / self.size


class Machine:
    """The chain [w X Y b Z t], X and Y counted as their carriages go, reference point in the origin."""

    def __init__(self, draw, population, size=1.0, roughness=1.0, sharp=False, tails=False):
        even = lambda: draw.choice([-1, 1]) * draw.uniform(0.3, 1.6)  # 1 rms
        amount = lambda: draw.standard_t(3) / np.sqrt(3) if tails else even()
        self.shape, self.amount, self.line = {}, {}, {}
        for k, axis in enumerate(AXES):
            for m, motion in enumerate(MOTIONS):
                kind = "positioning_um" if m == k else "straightness_um" if m < 3 else \
                    "roll_urad" if m == k + 3 else "pitch_urad"
                name = motion + axis
                self.shape[name] = Shape(draw, population["smoothness_mm"] * 1e-3 / roughness, sharp)
                self.amount[name] = size * population[kind] * 1e-6 * amount()
                self.line[name] = size * population["scale_ppm"] * 1e-6 * draw.normal() if m == k else 0.0
                if m < 3:  # the least-squares line of a shape belongs to the scale or the squareness
                    u = (np.arange(2000) + 0.5) * TRAVEL / 2000
                    self.line[name] -= self.amount[name] * np.polyfit(u, self.shape[name](u), 1)[0]
        self.squareness = size * population["squareness_urad"] * 1e-6 * draw.normal(size=3)  # A0Z B0Z C0Y

    def error(self, name, q):
        """The true error function in m or rad at positions q in m."""
        shape = self.shape[name]
        return self.amount[name] * (shape(q) - shape(0.0)) + self.line[name] * np.asarray(q)

    def carriage(self, axis, q, more):
        k = AXES.index(axis)
        motion = np.stack([self.error(m + axis, q) for m in MOTIONS], axis=1) + more
        a0z, b0z, c0y = self.squareness
        lean = {"X": (0, 0, 0), "Y": (0, 0, c0y), "Z": (a0z, b0z, 0)}[axis]
        return turn(motion[:, 3:]), q[:, None] * turn(lean)[0][:, k] + motion[:, :3]

    def poses(self, q, more):
        """Workpiece and tool seen from the bed, at positions q (n, 3); `more`: (n, 6) an axis."""
        x, y, z = (self.carriage(axis, q[:, k], more[axis]) for k, axis in enumerate(AXES))
        return joined(y, x), z
