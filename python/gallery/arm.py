#!/usr/bin/env python3
"""A robot arm before a laser tracker: drawn with errors of its geometry, calibrated, tested on poses that took no part.

    python3 python/gallery/arm.py [FOLDER]
"""
import matplotlib.pyplot as plt
import numpy as np

import abbe
import rig

TRACKER_UM, POSES, TESTS = 20.0, 150, 60
FITTED = ("tilt", "shift", "ball", "encoder_offset")  # errors of the geometry

out = rig.folder()
random = np.random.default_rng(7)
machine = abbe.read_machine(rig.ROOT / "machines" / "motoman_left.toml")
model = abbe.LinkageModel(machine)

# The arm as it is: parameters of the geometry off their nominal values by a third of a millimetre or milliradian.
is_geometry = np.array([name.startswith(FITTED) for name in model.names])
parameters = model.values + np.where(is_geometry, random.normal(scale=3e-4, size=len(model.names)), 0.0)


def poses(count, name):
    """A recording of poses all over the workspace, as the encoders and a tracker give them."""
    angles_rad = random.uniform(-1.0, 1.0, size=(count, model.joints))
    seen_m = model.tips(angles_rad, parameters=parameters) + [2.0, -1.0, 0.5]  # the tracker stands elsewhere
    seen_m += random.normal(scale=1e-6 * TRACKER_UM, size=seen_m.shape)
    columns = {"time_s": np.arange(count, dtype=float)}
    columns |= {f"pivot_{joint + 1}_rad": angles_rad[:, joint] for joint in range(model.joints)}
    columns |= {f"ref_{axis}_mm": 1e3 * seen_m[:, i] for i, axis in enumerate("xyz")}
    columns["ref_u_um"] = np.full(count, TRACKER_UM)
    return abbe.Recording(f'kind = "linkage"\nmachine = "{machine.name}"\ntime = "order"', columns, name)


test = poses(TESTS, "test")
sizes = (15, 25, 40, 70, POSES)
all_poses = poses(POSES, "poses")
figures = []
for size in sizes:
    part = abbe.Recording(all_poses.header, {name: all_poses[name][:size] for name in all_poses.columns}, "poses")
    found = abbe.calibrate_arm([part], machine, [test])
    figures.append((found.test_rms_before_m[0], found.test_rms_m[0]))
    print(f"{size} poses: the test is off by {1e3 * figures[-1][0]:.3f} mm, calibrated {1e3 * figures[-1][1]:.3f} mm")
found.write(out / "arm.toml")

figure, panel = plt.subplots(figsize=(6, 4.2), layout="constrained")
for column, label in ((0, "as in the machine file"), (1, "calibrated")):
    panel.loglog(sizes, [1e3 * each[column] for each in figures], marker="o", label=label)
panel.axhline(1e-3 * TRACKER_UM * np.sqrt(3), color="grey", linestyle=":", label="noise of the tracker")
panel.set_xlabel("poses of the calibration")
panel.set_ylabel("rms of the test in mm")
panel.legend()
figure.savefig(out / "arm.png", dpi=110)
