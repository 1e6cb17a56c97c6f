"""Tables of the results, Markdown."""
import collections

import numpy as np


def rows(header, body):
    lines = [header, "|".join(["---"] * len(header)).split("|"), *body]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def grouped(lines):
    groups = collections.defaultdict(list)
    for line in lines:
        groups[line["effect"]].append(line)
    return groups


def middle(values):
    values = [v for v in values if v is not None and np.isfinite(v)]
    return f"{np.median(values):.3g}" if values else "-"


def count(lines, test):
    return f"{sum(map(bool, map(test, lines)))}/{len(lines)}"


def diagnoses(lines):
    """Per effect: verdicts; worlds with a certain finding that is not there; with its place named; sizes."""
    body = []
    for name, some in [*grouped(lines).items(), ("all", lines)]:
        verdicts = collections.Counter(line["verdict"] for line in some)
        sizes = [v for line in some for v in line.get("sizes", {}).values()]
        body.append((name, middle([line.get("size_sd") for line in some]),
                     ", ".join(f"{n} {v}" for v, n in verdicts.items()), count(some, lambda r: r["wrong"]),
                     count(some, lambda r: r.get("named")), count(sizes, lambda v: abs(v) <= 1),
                     middle([line.get("seconds") for line in some]),
                     ", ".join(sorted({w for line in some for w in line["wrong"]})) if name != "all" else ""))
    return rows(("effect", "sd", "verdicts", "certain and wrong", "named", "sizes in U95", "s", "which"), body)


def maps(lines):
    """Per effect: share of the truth inside U95 in worlds that were told, of functions, volume and sweeps."""
    body = []
    for name, some in [*grouped(lines).items(), ("all", lines)]:
        what = collections.Counter(line["map"] for line in some)
        made = [line for line in some if "inside" in line]
        sweeps = [s["inside"] for line in some for s in line["sweeps"].values()]
        mean = lambda values: f"{np.nanmean(values):.3f}" if len(values) else "-"
        body.append((name, ", ".join(f"{n} {v}" for v, n in what.items()), mean([m["inside"] for m in made]),
                     mean([m["volume"]["inside"] for m in made]), mean(sweeps), count(made, lambda m: m["innocent"]),
                     ", ".join(sorted({b for m in made for b in m["innocent"]})) if name != "all" else ""))
    return rows(("effect", "maps", "functions inside", "volume inside", "sweeps inside", "blames an innocent",
                 "whom"), body)


def corrections(lines):
    """Per effect: rms error of the map over the volume without and with the findings, um."""
    body = []
    for name, some in [*grouped(lines).items(), ("all", lines)]:
        um = lambda m, key: m["volume"][key] * 1e6 if "volume" in m else None
        body.append((name, middle([um(r.get("without", {}), "rms") for r in some]),
                     middle([um(r.get("with", {}), "rms") for r in some]),
                     middle([um(r.get("with", {}), "u") for r in some]),
                     count(some, lambda r: r.get("with", {}).get("map") == "refused"),
                     count(some, lambda r: r.get("worse"))))
    return rows(("effect", "without um", "with um", "u um", "refused", "worse by more than U95"), body)


def of(lines):
    """The table that fits lines of results; lines of several modes give several tables."""
    modes = ((maps, [r for r in lines if "map" in r]), (corrections, [r for r in lines if "without" in r]),
             (diagnoses, [r for r in lines if "verdict" in r]))
    return "\n\n".join(make(some) for make, some in modes if some)
