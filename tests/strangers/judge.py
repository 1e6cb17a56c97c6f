"""What a result of abbe is worth, held against the truth of a world."""
import re

import numpy as np

from machine import AXES, MOTIONS

CERTAIN = 0.99
K95 = 1.96


def same_thing(finding, effect):
    """Whether a finding is honestly the hidden effect in other words: the few that Effect.same_as lists."""
    values = {p["name"]: p["value"] for p in finding["parameters"]}
    for cause, thing, bounds in effect.same_as if effect else ():
        if finding["cause"] == cause and thing in (None, finding["object"]) and \
                all(low <= values.get(name, np.nan) <= high for name, (low, high) in bounds.items()):
            return True
    return False


def sizes(result, effect):
    """Error over U95 of each parameter of the findings that are the hidden effect."""
    return {p["name"]: (p["value"] - effect.truth[p["name"]]) / p["u95"]
            for f in result["findings"] if same_thing(f, effect) for p in f["parameters"]
            if p["name"] in effect.truth and p["u95"] > 0}


def diagnosis(result, effect):
    """Of the JSON of `abbe diagnose`: verdict, certain findings that are wrong, whether the place was named."""
    told = [f"{f['cause']}:{f['object']}" for f in result["findings"]]
    chance = [f["probability"] for f in result["findings"]]
    wrong = [name for name, p, f in zip(told, chance, result["findings"])
             if p >= CERTAIN and not same_thing(f, effect)]
    right = any(p >= CERTAIN and same_thing(f, effect) for p, f in zip(chance, result["findings"]))
    leftovers = [(u["variable"], u["object"]) for u in result["unexplained"]]
    alike = [(o["variable"], o["object"]) for u in result["unexplained"] for o in u.get("one_of", ())]
    words = {w for variable, thing in leftovers + alike for w in (*re.split("[-+* ]", variable), variable, thing)}
    return {"verdict": result["verdict"], "findings": list(zip(told, chance)), "wrong": wrong,
            "advised": [t for t, f in zip(told, result["findings"])
                        if t in wrong and f.get("words", {}).get("remedy")],
            "unexplained": leftovers, "or": alike, "right": right, "sizes": sizes(result, effect),
            "named": right or bool(effect and words & set(effect.named_by))}


def true_errors(machine, errors):
    """The truth at the places of map.errors or of a sweep's result, by name."""
    square = dict(zip(("A0Z", "B0Z", "C0Y"), machine.squareness))
    return {name: square[name] if name in square else machine.error(name, np.array(e["positions"]))
            for name, e in errors.items()}


def pulls(value, u, truth):
    """Error over standard uncertainty, where one is stated; what the gauge makes zero has none."""
    value, u, truth = (np.atleast_1d(np.asarray(v, float)) for v in (value, u, truth))
    stated = u > 1e-6 * max(u.max(), 1e-30)
    return ((value - truth)[stated] / u[stated]).tolist()


def coverage(ratios):
    return float(np.mean(np.abs(ratios) <= K95)) if len(ratios) else float("nan")


def map_pulls(result, machine):
    errors = result["map"]["errors"]
    truth = true_errors(machine, errors)
    return {name: pulls(e["value"], e["u"], truth[name]) for name, e in errors.items()}


def without_frame(off, q):
    """Displacements (3, n) at q (n, 3) less the rigid motion of all of them, in least squares."""
    turns = np.stack([np.cross(axis, q) for axis in np.eye(3)], axis=2)
    motions = np.concatenate([np.tile(np.eye(3), (len(q), 1, 1)), turns], axis=2).reshape(-1, 6)
    moved = motions @ np.linalg.lstsq(motions, off.T.ravel(), rcond=None)[0]
    return off - moved.reshape(-1, 3).T


def volume_error(result, world):
    """Largest and rms error of the map over its grid, m, and the rms of its u: the truth by exact motions.

    An effect that tilts a carriage as another axis moves tilts the travel of that axis, and with it the frame in which
    a map is stated: beside such an effect the two are compared up to a rigid motion.
    """
    grid = result["map"]["grid"]
    z, y, x = np.meshgrid(grid["z"], grid["y"], grid["x"], indexing="ij")
    q = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    truth = world.tool_error(q, np.array(result["map"]["tool"])).T
    off = np.array(grid["error"]).reshape(3, -1) - truth
    if {"carriage", "travel"} & set(world.hooks):
        off = without_frame(off, q)
    u = np.array(grid["u"]).reshape(3, -1)
    return {"rms": float(np.sqrt(np.mean(off**2))), "u": float(np.sqrt(np.mean(u**2))),
            "worst": float(np.abs(off).max()), "inside": coverage(off[u > 0] / u[u > 0])}


def sweep_pulls(result, machine, axis):
    """Of `abbe reduce`: the five error motions at the stations, in the sweep's gauge."""
    q = np.array(result["stations"])
    found = {}
    for name, error in result["errors"].items():
        truth = machine.error(name, q)
        if name[1] in "XYZ":
            truth = truth - np.polyval(np.polyfit(q, truth, 1), q)
        else:
            truth = truth - truth[0]
        found[name] = pulls(error["value"], error["u"], truth)
    return found
