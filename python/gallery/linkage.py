#!/usr/bin/env python3
"""The calibration of the linkage, and a circle with it, beside what a grid encoder saw of the same circle.

    ABBE=build/release/apps/abbe python3 python/gallery/linkage.py [FOLDER]
"""
import matplotlib.pyplot as plt
import numpy as np

import abbe
import rig

out = rig.folder()
machine = abbe.read_machine(rig.MACHINE)
cube = abbe.read_recording(rig.record(out / "cube.csv", "--course", "cube", "--size", "45", "--points", "5,5,5",
                                      "--dwell", "0.2", "--feed", "2000", "--reference"))
calibration = abbe.calibrate([cube], machine)
calibration.write(out / "linkage.toml")
print(f"poses: {1e6 * calibration.rms_before_m:.1f} um rms with the nominal linkage, "
      f"{1e6 * calibration.rms_m:.2f} um calibrated, {1e6 * calibration.held_out_rms_m:.2f} um held out")

circle = abbe.read_recording(rig.record(out / "circle.csv", "--course", "circle", "--feed", "300", "--reference"))
paths = [abbe.linkage_path(circle, machine, out / "linkage.toml"), abbe.reference_path(circle)]
circles = [abbe.circles([path], filter=50)[0] for path in paths]

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
for gaps, name in ((calibration.residuals_before_m, "nominal"), (calibration.residuals_m, "calibrated")):
    left.hist(np.log10(1e6 * np.linalg.norm(gaps, axis=1)), bins=20, alpha=0.6, label=name)
left.set_xlabel("distance from the true place, log10 of µm")
left.set_ylabel("poses")
left.legend()
for each in circles:
    is_ccw = each.sense > 0
    angle = np.unwrap(each.angle_rad[is_ccw])
    deviation = 1e6 * (np.hypot(*each.points_m[is_ccw, :2].T) - each.radius_m)
    right.plot(np.degrees(angle), deviation, linewidth=1, label=each.instrument)
    print(f"circle by the {each.instrument}: G(b) {1e6 * each.figures_m['G_b_m']:.2f} um")
right.set_xlabel("angle in degrees")
right.set_ylabel("radial deviation in µm, counter-clockwise")
right.legend()
figure.savefig(out / "linkage.png", dpi=110)
