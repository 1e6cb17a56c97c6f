#!/usr/bin/env python3
"""An effect that is in no catalogue, hidden in the virtual machine, and learned: what was left, and the term beside it.

    ABBE=build/release/apps/abbe python3 python/gallery/learned.py [FOLDER]
"""
import matplotlib.pyplot as plt
import numpy as np

import abbe
import rig

out = rig.folder()
machine = abbe.read_machine(rig.MACHINE)
rig.record(out / "strange", "--campaign", "standard", "--reduced", "--hide", "unknown-feed-square:object=X:height_um=8",
           seed=5)
recordings = [abbe.read_recording(file) for file in sorted((out / "strange").glob("*.h5"))]
diagnosis = abbe.diagnose(recordings, machine, learn=True)
print(diagnosis.verdict)
for term in diagnosis.terms:
    print(term.words)

(learned,) = diagnosis.to_dict()["learned"]
(of_feed,), (u95,) = learned["coefficients"], learned["u95"]
(range_,) = (each for each in learned["covered"] if each["variable"] == "feed")
feed = np.linspace(range_["from"], range_["to"], 100)
figure, axes = plt.subplots(figsize=(6, 4.4), layout="constrained")
axes.fill_between(feed, (of_feed - u95) * feed**2, (of_feed + u95) * feed**2, alpha=0.3, label="U95")
axes.plot(feed, of_feed * feed**2, label=f"learned: {learned['expression']}")
axes.plot(feed, 8.0 * (feed / 600.0) ** 2, "--", label="hidden: 8 um at 600 mm/min")
axes.set_xlabel("feed in mm/min")
axes.set_ylabel(f"{learned['object']} in {learned['unit']}")
axes.legend()
figure.savefig(out / "learned.png", dpi=110)
