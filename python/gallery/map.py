#!/usr/bin/env python3
"""One error map from sweeps, a volume of the linkage and a line of lengths: the error in a plane, its uncertainty,
and what a correction by the map leaves of a circle.

    ABBE=build/release/apps/abbe python3 python/gallery/map.py [FOLDER]
"""
import matplotlib.pyplot as plt
import numpy as np

import abbe
import rig

out = rig.folder()
machine = abbe.read_machine(rig.MACHINE)
files = [rig.record(out / f"sweep_{axis}.csv", "--axis", axis) for axis in "XYZ"]
files.append(rig.record(out / "volume.csv", "--course", "cube", "--size", "57", "--points", "5,5,5", "--dwell", "0.2",
                        "--feed", "6000"))
files.append(rig.record(out / "line.csv", "--length", "X"))
report = abbe.fuse([abbe.read_recording(file) for file in files], machine)
map_ = report.map
map_.write(out / "map.toml")

(x0, x1), (y0, y1), (z0, z1) = map_.travels_m
x, y = np.meshgrid(np.linspace(x0, x1, 41), np.linspace(y0, y1, 41))
positions_m = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, (z0 + z1) / 2)])
error = map_.error(positions_m)
u95 = 2 * map_.standard_uncertainty(positions_m)

figure, panels = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
for panel, values, title in zip(panels, (error, u95), ("error", "U95")):
    size = 1e6 * np.linalg.norm(values, axis=1).reshape(x.shape)
    drawn = panel.contourf(1e3 * x, 1e3 * y, size, levels=15)
    figure.colorbar(drawn, ax=panel, label=f"{title} in µm")
    panel.set_xlabel("X in mm")
    panel.set_ylabel("Y in mm")
    panel.set_aspect("equal")
few = (slice(None, None, 8), slice(None, None, 8))
panels[0].quiver(1e3 * x[few], 1e3 * y[few], error[:, 0].reshape(x.shape)[few], error[:, 1].reshape(x.shape)[few],
                 color="white")
panels[0].set_title(f"in the plane Z = {1e3 * (z0 + z1) / 2:.0f} mm")
figure.savefig(out / "map.png", dpi=110)

wanted_m = np.array([[x0 + x1, y0 + y1, z0 + z1]]) / 2
command_m = abbe.Corrector(map_).command(wanted_m)
print(f"largest error {1e6 * np.linalg.norm(error, axis=1).max():.2f} um; to reach the middle, command "
      f"{np.round(1e3 * command_m[0], 4)} mm")
circle = abbe.simulate(map_, "circle", draws=200)
for name, value in circle["as_is"].items():
    print(f"circle {name}: {1e6 * value:.2f} um as it is, below {1e6 * circle['corrected_p95'][name]:.2f} um corrected")
