"""Recordings of the linkage of the demonstration machine along any path, from a kinematics of their own."""
import math

HEADER = ["# abbe-recording = 1", '# kind = "linkage"', '# machine = "demo-mill"',
          "# started = 2026-11-21T09:00:00Z"]
LINK = 120.0
BASE = (-180.0, -30.0, -30.0)  # mm, of the base in the machine as the table carries it
SIGNS = (-1, -1, 1)  # [w X Y b Z t]: the table carries X and Y


def angles(position):
    """Encoder angles for axis positions (mm): the elbow up, by the law of cosines."""
    x, y, z = (s * p - b for s, p, b in zip(SIGNS, position, BASE))
    reach = math.hypot(x, y)
    distance = math.hypot(reach, z)
    half = math.acos(distance / (2 * LINK))  # between link 1 and the line to the ball
    raised = math.atan2(z, reach)
    first = raised + half  # of link 1 above the horizontal
    elbow = (LINK * math.cos(first), LINK * math.sin(first))
    second = math.atan2(z - elbow[1], reach - elbow[0])
    # q2 > 0 lowers link 1; link 2 stands along z when q2 = q3 = 0, and q3 > 0 lowers it too.
    return math.atan2(y, x), -first, math.pi / 2 - second + first


def write(path, rows, reference=False, linkage=True, header=()):
    """rows: (commanded, actual, pass, direction, feed) with positions in mm."""
    names = ["time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min"]
    names += ["pivot_1_rad", "pivot_2_rad", "pivot_3_rad"] if linkage else []
    names += ["ref_x_mm", "ref_y_mm", "ref_z_mm"] if reference else []
    lines = [*HEADER, *header, ",".join(names + ["flags"])]
    if not linkage:
        lines[1] = '# kind = "reference"'
    for number, (commanded, actual, turn, direction, feed) in enumerate(rows):
        values = [0.01 * number, *commanded, turn, direction, feed]
        values += angles(actual) if linkage else []
        values += actual if reference else []
        lines.append(",".join(repr(float(value)) for value in [*values, 0]))
    path.write_text("\n".join(lines) + "\n")
    return str(path)
