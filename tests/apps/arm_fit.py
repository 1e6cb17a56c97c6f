"""An arm fitted by NumPy alone, for the tests of `abbe calibrate`: its own chain of rows, with four small numbers for
each row and one more (Hayati's) at parallel axes, and its own place of the tracker."""
import numpy as np
from scipy.optimize import least_squares


def turned(axis, angle):
    """Rotations about a coordinate axis, one for each angle."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.zeros((*np.shape(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[..., axis, axis] = 1.0
    R[..., i, i] = R[..., j, j] = c
    R[..., i, j], R[..., j, i] = -s, s
    return R


def tips(rows, ball, q):
    """rows: theta, d, a, alpha, beta (rad, mm); q: poses x joints; mm, in the frame before the first row."""
    p = np.broadcast_to(np.asarray(ball, dtype=float), (len(q), 3))
    for (theta, d, a, alpha, beta), angle in reversed(list(zip(rows, q.T))):
        p = p @ (turned(0, alpha) @ turned(1, beta)).T + [a, 0.0, 0.0]
        p = np.einsum("nij,nj->ni", turned(2, theta + angle), p) + [0.0, 0.0, d]
    return p


def registered(p, seen):
    """R, t with seen = R p + t in the mean (Arun, Huang and Blostein 1987)."""
    middle, there = p.mean(axis=0), seen.mean(axis=0)
    U, _, V = np.linalg.svd((p - middle).T @ (seen - there))
    R = V.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(V.T @ U.T))]) @ U.T
    return R, there - R @ middle


def rms(gaps):
    return np.sqrt((gaps**2).sum(axis=1).mean())


class ArmFit:
    """`free`: rows x 5, which numbers are fitted; the ball always is. Of what the data do not tell, such as theta and d
    of the first row, nothing is asked: steps are the shortest."""

    def __init__(self, rows, ball, q, seen, free):
        self.rows, self.free = np.array(rows, dtype=float), np.array(free, dtype=bool)
        R, t = registered(tips(self.rows, ball, q), seen)
        self.R0 = R
        start = np.concatenate([np.zeros(3), t, np.zeros(self.free.sum()), ball])
        scale = np.concatenate([np.full(3, 1e-3), np.ones(3), np.where(np.isin(np.nonzero(self.free)[1], (1, 2)), 1.0,
                                                                       1e-3), np.ones(3)])
        fit = least_squares(lambda x: (self.at(start + scale * x, q) - seen).ravel(), np.zeros(len(start)), method="lm")
        self.x = start + scale * fit.x

    def at(self, x, q):
        rows = self.rows.copy()
        rows[self.free] += x[6:-3]
        angle = np.linalg.norm(x[:3])
        k = x[:3] / angle if angle > 0 else x[:3]
        K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        R = self.R0 @ (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)
        return tips(rows, x[-3:], q) @ R.T + x[3:6]

    def gaps(self, q, seen):
        return self.at(self.x, q) - seen
