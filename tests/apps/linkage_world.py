"""A linkage of three pivots with errors on a perfect machine [w X Y b Z t]: recordings to calibrate with.

Written from the figure of the RELM paper as one product of rotations; shares no code with the program. SI.
"""
import numpy as np
from scipy.spatial.transform import Rotation

NOMINAL = dict(link_1=0.120, link_2=0.120, tilt=(0, 0), twist_2=0, twist_link=0, divergence=(0, 0),
               offset=(0, 0, 0), sine=(0, 0, 0), cosine=(0, 0, 0), run_out=(0, 0, 0), base=(-0.18, -0.03, -0.03),
               turn=(0, 0, 0))


def draw(seed):
    rng = np.random.default_rng(seed)
    n = rng.normal
    return dict(link_1=0.120 + n(0, 1e-4), link_2=0.120 + n(0, 1e-4), tilt=n(0, 5e-4, 2), twist_2=n(0, 5e-4),
                twist_link=n(0, 5e-4), divergence=n(0, 2e-5, 2), offset=n(0, 1e-3, 3), sine=n(0, 2e-5, 3),
                cosine=n(0, 2e-5, 3), run_out=n(0, 1e-6, 3), base=np.array(NOMINAL["base"]) + n(0, 5e-4, 3),
                turn=n(0, 2e-3, 3))


def turned(axis, angles):
    return Rotation.from_rotvec(np.outer(np.atleast_1d(angles), np.eye(3)["xyz".index(axis)]))


def ball(world, q):
    """p_MT, poses x 3, of encoder readings q, poses x 3."""
    angle = q + np.asarray(world["offset"]) + np.asarray(world["sine"]) * np.sin(q) \
        + np.asarray(world["cosine"]) * np.cos(q)
    run_out = np.asarray(world["run_out"]) * np.cos(2 * q)  # along the link after each pivot
    p = np.zeros((len(q), 3))
    p[:, 2] = world["link_2"] + run_out[:, 2]
    p = turned("y", angle[:, 2]).apply(p)
    p = turned("x", world["twist_link"]).apply(p)
    p[:, 0] += world["link_1"] + run_out[:, 1]
    p = turned("y", angle[:, 1]).apply(p)
    p += np.array([*world["divergence"], 0.0])
    p = turned("x", world["twist_2"]).apply(p)
    p[:, 0] += run_out[:, 0]
    p = turned("z", angle[:, 0]).apply(p)
    p = turned("x", world["tilt"][0]).apply(turned("y", world["tilt"][1]).apply(p))
    return np.asarray(world["base"]) + Rotation.from_rotvec(world["turn"]).apply(p)


def readings(world, p_MT):
    """Encoder readings with the ball at p_MT, elbow up: closed form, then Newton steps."""
    p = p_MT - np.asarray(NOMINAL["base"])
    radius = np.hypot(p[:, 0], p[:, 1])
    inside = (radius**2 + p[:, 2]**2 - 2 * 0.12**2) / (2 * 0.12**2)
    q3 = np.arcsin(inside)
    along, up = 0.12 + 0.12 * np.sin(q3), 0.12 * np.cos(q3)
    q = np.stack([np.arctan2(p[:, 1], p[:, 0]), np.arctan2(up, along) - np.arctan2(p[:, 2], radius), q3], axis=1)
    for _ in range(8):
        J = np.stack([(ball(world, q + 1e-6 * e) - ball(world, q - 1e-6 * e)) / 2e-6 for e in np.eye(3)], axis=2)
        q = q + np.linalg.solve(J, (p_MT - ball(world, q))[:, :, None])[:, :, 0]
    return q


def cube(n, size):
    """Axis positions of a grid in the middle of 60 mm of travel, row after row along x."""
    sides = [0.030 + s * (np.arange(k) / (k - 1) - 0.5) for k, s in zip(n, size)]
    z, y, x = np.meshgrid(sides[2], sides[1], sides[0], indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def record(path, world, positions, seed=0, encoder=3e-6, reference=0.3e-6, change=lambda q: q, with_reference=True,
           columns=("pivot_1_rad", "pivot_2_rad", "pivot_3_rad")):
    """Writes one row for each axis position."""
    rng = np.random.default_rng(seed)
    q = readings(world, positions * [-1, -1, 1])
    q = change(q + rng.normal(0, encoder, q.shape)) if encoder else change(q)
    ref = positions + rng.normal(0, reference, positions.shape)
    names = ["time_s", "x_mm", "y_mm", "z_mm", *(["ref_x_mm", "ref_y_mm", "ref_z_mm"] if with_reference else []),
             "pass", "direction", "feed_mm_min", *columns, "temp_table_c", "flags"]
    lines = ["# abbe-recording = 1", '# kind = "linkage"', '# machine = "demo-mill"', ",".join(names)]
    for i, p in enumerate(positions):
        row = [i * 1.0, *(1e3 * p), *(1e3 * ref[i] if with_reference else []), 1, 1, 600, *q[i], 20.0, 0]
        lines.append(",".join(repr(float(value)) for value in row))
    path.write_text("\n".join(lines) + "\n")
    return str(path)
