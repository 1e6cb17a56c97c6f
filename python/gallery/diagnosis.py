#!/usr/bin/env python3
"""Backlash hidden in the virtual machine, and found: what a circle shows before and after it is taken out.

    ABBE=build/release/apps/abbe python3 python/gallery/diagnosis.py [FOLDER]
"""
import matplotlib.pyplot as plt

import abbe
import rig

out = rig.folder()
machine = abbe.read_machine(rig.MACHINE)
circle = abbe.read_recording(rig.record(out / "circle.csv", "--kind", "reference", "--course", "circle", "--passes", "2",
                                        "--rate", "20", "--hide", "backlash:object=X:width_um=8", seed=3))
diagnosis = abbe.diagnose([circle], machine)
print(diagnosis.verdict)
for finding in diagnosis.findings:
    print(finding)
    for name, (value, u95) in finding.parameters.items():
        print(f"  {name} = {value:.3f} +- {u95:.3f}")

data = diagnosis.to_dict()
curve = data["findings"][0]["curve"]
evidence = sorted(data["evidence"], key=lambda each: -each["log_evidence"])[:8]
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
left.plot(curve["x"], curve["before"], ".", label="without the cause")
left.plot(curve["x"], curve["after"], ".", label="with it")
left.set_xlabel(curve["variable"])
left.set_ylabel(f"measured less simulated in {curve['unit']}")
left.legend()
right.barh([f"{each['cause']}:{each['object']}" for each in evidence][::-1],
           [each["log_evidence"] for each in evidence][::-1])
right.set_xlabel("log evidence of a cause alone")
figure.savefig(out / "diagnosis.png", dpi=110)
