#!/usr/bin/env python3
"""A sweep of X by the five-probe head: five errors with their uncertainty.

    ABBE=build/release/apps/abbe python3 python/gallery/sweep.py [FOLDER]
"""
import matplotlib.pyplot as plt

import abbe
import rig

out = rig.folder()
machine = abbe.read_machine(rig.MACHINE)
recording = abbe.read_recording(rig.record(out / "sweep_X.csv", "--axis", "X"))
result = abbe.reduce_sweep(recording, machine)

figure, panels = plt.subplots(len(result.errors), 1, sharex=True, figsize=(7, 9), layout="constrained")
for panel, error in zip(panels, result.errors):
    value, u95 = 1e6 * result.value(error), 1e6 * result.coverage(error) * result.u(error)
    panel.fill_between(1e3 * result.stations_m, value - u95, value + u95, alpha=0.3, linewidth=0)
    panel.plot(1e3 * result.stations_m, value, marker=".")
    panel.set_ylabel(f"{error} in {'µrad' if error[1] in 'ABC' else 'µm'}")
    print(f"{error}  largest {abs(value).max():.3f}, U95 {u95.max():.3f}")
panels[-1].set_xlabel("X in mm")
panels[0].set_title(f"Sweep of {result.axis} of {result.machine}; the band is U95")
figure.savefig(out / "sweep.png", dpi=110)
