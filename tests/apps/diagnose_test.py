#!/usr/bin/env python3
"""abbe diagnose as a script uses it: planning before anything is measured, and the run to make next.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml diagnose_test.py
"""
import json
import math
import pathlib
import unittest

from program_case import MACHINE, ProgramCase

# What the keys of causes are called and measured in, written down by hand.
UNITS = {
    "amplitude_um": ("amplitude", "um"), "amplitude_urad": ("amplitude", "urad"), "angle_urad": ("angle", "urad"),
    "bow_um": ("bow", "um"), "change_um": ("change", "um"), "from_mm": ("from", "mm"), "to_mm": ("to", "mm"),
    "coefficient": ("coefficient", ""), "coefficient_nm_per_mm2": ("coefficient", "nm/mm^2"),
    "coefficient_ppm_per_c": ("coefficient", "ppm/degC"), "compliance_urad": ("compliance", "urad"),
    "cos_urad": ("cos", "urad"), "sin_urad": ("sin", "urad"), "decay_mm": ("decay", "mm"), "delay_ms": ("delay", "ms"),
    "delta": ("delta", ""), "displacement_um": ("displacement", "um"), "du_mm": ("du", "mm"), "dv_mm": ("dv", "mm"),
    "electrode_radius_mm": ("electrode radius", "mm"), "feed_mm_min": ("feed", "mm/min"),
    "frequency_hz": ("frequency", "Hz"), "gain_ppm": ("gain", "ppm"), "height_um": ("height", "um"),
    "order": ("order", ""), "phase_rad": ("phase", "rad"), "pitch_mm": ("pitch", "mm"), "pitch_urad": ("pitch", "urad"),
    "quadratic_per_mm": ("quadratic", "1/mm"), "rms_um": ("rms", "um"), "roll_urad": ("roll", "urad"),
    "time_constant_s": ("time constant", "s"), "time_s": ("time", "s"), "width_um": ("width", "um"),
    "width_urad": ("width", "urad"), "yaw_urad": ("yaw", "urad"),
    **{f"{wave}{order}_um": (f"{wave}{order}", "um") for wave in ("sin", "cos") for order in (2, 3, 4)},
}


def circle(feed_mm_min):
    """A circle in XY of 20 mm about the middle of the travels, as a path; its angles are none."""
    lines = ['# abbe-recording = 1', '# kind = "linkage"', "time_s,x_mm,y_mm,z_mm,pass,direction,pivot_1_rad"]
    turn = 2 * math.pi * 20 / (feed_mm_min / 60)
    for which, sense in ((1, 1), (2, -1)):
        for row in range(180):
            angle = sense * math.radians(2 * row)
            lines.append(f"{(turn + 5) * (which - 1) + turn * row / 180:.6f},{30 + 20 * math.cos(angle):.9f},"
                         f"{30 + 20 * math.sin(angle):.9f},30,{which},{sense},0")
    return "\n".join(lines) + "\n"


class PlanTest(ProgramCase):
    command = "diagnose"

    def plan(self, *arguments):
        out = self.path / "plan.json"
        text = self.done("--plan", *arguments, "--machine", MACHINE, "--json", out)
        return json.loads(out.read_text()), text

    def path_file(self, feed):
        path = self.path / f"circle_{feed}.csv"
        path.write_text(circle(feed))
        return path

    def alike(self, plan):
        return {tuple(pair["causes"]) for pair in plan["alike"]}

    def test_the_readings_of_a_path_do_not_count(self):
        pair = ("cap-friction:cap", "clock-skew:linkage")
        one, text = self.plan(self.path_file(600))
        self.assertIn(pair, self.alike(one))
        self.assertIn("Cannot be separated (cosine 1.000): cap-friction:cap, cap-trailing:cap, clock-skew:linkage", text)
        two, _ = self.plan(self.path_file(600), self.path_file(120))
        self.assertNotIn(pair, self.alike(two))

    def test_more_runs_show_more(self):
        minimal, text = self.plan("--campaign", "minimal")
        standard, _ = self.plan("--campaign", "standard")
        seen = lambda plan: {f'{one["cause"]}:{one["object"]}' for one in plan["causes"] if one["seen"]}
        self.assertGreater(len(seen(standard)), len(seen(minimal)))
        self.assertLessEqual({"backlash:X", "leadscrew-cyclic:Y"}, seen(minimal))
        # Hidden in every campaign within plausible sizes.
        for plan in (minimal, standard):
            self.assertIn("probe-position:probe_a", plan["cannot_show"])
            self.assertIn("fixture-misalignment:head", plan["cannot_show"])
        play = next(one for one in minimal["causes"] if one["cause"] == "backlash")
        size = play["sizes"][0]
        self.assertEqual((size["name"], size["quantity"], size["unit"]), ("width_um", "width", "um"))
        sizes = {size["name"]: (size["quantity"], size["unit"]) for one in minimal["causes"] for size in one["sizes"]}
        self.assertGreater(len(sizes), 8)
        for name, (quantity, unit) in sizes.items():
            self.assertEqual((quantity, unit), UNITS[name], name)
        self.assertAlmostEqual(size["seen_from"], 5 * size["plausible"] / play["visible_sd"])
        self.assertIn("backlash:X", text)

    def test_a_run_is_proposed_where_rivals_are_left(self):
        campaign = self.path / "campaign"
        self.done("--machine", MACHINE, "--seed", 4, "--campaign", "minimal", "--reduced", "--hide",
                  "clock-skew:object=linkage:delay_ms=0.5", "--out", campaign, command="rig record")
        found = self.result(*sorted(campaign.glob("*.h5")), "--machine", MACHINE)
        rivals = next(one for one in found["rivals"] if "clock-skew:linkage" in one["causes"])
        self.assertIn("circle", rivals["next_run"])
        self.assertGreater(rivals["expected_odds"], max(rivals["odds"]))

    def test_what_cannot_be_planned_is_refused(self):
        self.refuse("--plan", "--machine", MACHINE, saying=["no run to plan with", "--campaign standard"])
        self.refuse("--machine", MACHINE, saying=["no recording", "--plan"])
        machine = self.path / "without.toml"
        text = pathlib.Path(MACHINE).read_text()
        first, last = text.index("[linkage]"), text.index("[devices]")
        machine.write_text(text[:first] + text[last:])
        self.refuse("--plan", self.path_file(600), "--machine", machine, saying=["circle_600", "[linkage]"])


if __name__ == "__main__":
    unittest.main()
