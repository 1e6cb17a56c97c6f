#!/usr/bin/env python3
"""Worlds of strangers: abbe held against a simulated world that was written without looking at it.

The rig of the project hides effects of the catalogue, drawn from the population of the machine file. This
world was written from the documentation of the file formats, the equations of head, chain and linkage and the
machine file alone: its machine, head, linkage, noise and hidden effects share no code and no assumption with the
rig or the models. It is never tuned to, and no effect is taken out because it is hard: when a miss is mended,
the world it came from is replaced by fresh ones (another --seed).

    run.py --abbe build/dev/abbe --worlds 60 --seed 1 --out results.jsonl        # abbe diagnose
    run.py --abbe build/dev/abbe --worlds 20 --seed 1 --effect clean --wide --out clean.jsonl
    run.py --abbe build/dev/abbe --worlds 20 --seed 1 --map --out maps.jsonl     # abbe fuse and abbe reduce
    run.py --abbe build/dev/abbe --worlds 20 --seed 1 --apply --out applied.jsonl  # fuse --causes of a diagnosis
    run.py --table results.jsonl                                                 # the table once more

World i has seed S + i and, with --effect all, the i-th effect of effects.py in turn, with --effect usual that of
usual.py. One line of JSON a world.
"""
import argparse
import functools
import json
import multiprocessing
import pathlib
import resource
import subprocess
import tempfile

import judge
import table
from effects import EFFECTS
from usual import USUAL
from world import World, changes

HERE = pathlib.Path(__file__).resolve().parent
MACHINE = HERE.parents[1] / "machines" / "demo_mill.toml"
MAPPED = ("sweep", "space", "length")  # names of the runs of which a map is made
SLOW_CIRCLES = ("_120",)


def abbe(program, *arguments, limit=900):
    """(result or None, message, exit code, processor seconds) of a command with --json."""
    spent = lambda: resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    began = spent()
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "result.json"
        try:
            run = subprocess.run([program, *map(str, arguments), "--json", out], capture_output=True, text=True,
                                 timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return None, f"more than {limit} s", -1, spent() - began
        result = json.loads(out.read_text()) if out.exists() else None
    return result, run.stderr.strip(), run.returncode, spent() - began


def diagnosed(program, world, folder):
    result, message, code, seconds = abbe(program, "diagnose", *world.write_all(folder), "--machine", MACHINE)
    if result is None:
        return {"verdict": "refused", "message": message, "exit": code, "seconds": seconds, "wrong": []}
    return {**judge.diagnosis(result, world.effect), "seconds": seconds}


def map_of(program, world, folder, *options, names=MAPPED):
    """A map of the runs of these names, and how well its statements hold."""
    files = [f for f in world.write_all(folder) if any(word in f.name for word in names)]
    result, message, code, seconds = abbe(program, "fuse", *files, "--machine", MACHINE,
                                          "-o", folder / "map.toml", "--force", *options)
    if result is None:
        return {"map": "refused", "message": message, "exit": code, "seconds": seconds}
    ratios = judge.map_pulls(result, world.machine)
    blamed = [pathlib.Path(str(b.get("run", b)) if isinstance(b, dict) else str(b)).name
              for b in result["contradictions"] + result["misfits"]]
    may_be = [pathlib.Path(run).name for run in result.get("may_be_wrong", ())]
    if result["contradictions"] and not may_be:
        blamed = []  # no single run, it says
    return {"map": "flagged" if result["contradictions"] + result["misfits"] else "told", "blamed": blamed,
            "may_be_wrong": may_be, "message": message,
            "smoothness_mm": result["smoothness_mm"], "by_error": {n: judge.coverage(p) for n, p in ratios.items()},
            "inside": judge.coverage(sum(ratios.values(), [])), "volume": judge.volume_error(result, world),
            "seconds": seconds}


def mapped(program, world, folder, names=MAPPED):
    found = map_of(program, world, folder, names=names)
    found["sweeps"] = {}
    for run in world.runs:
        if run.kind == "sweep":
            result, message, _, _ = abbe(program, "reduce", folder / f"{run.name}.csv", "--machine", MACHINE)
            ratios = judge.sweep_pulls(result, world.machine, run.axis) if result else {}
            found["sweeps"][run.axis] = {"inside": judge.coverage(sum(ratios.values(), [])), "message": message,
                                         "notes": len(result["notes"]) if result else None}
    return found


def applied(program, world, folder):
    """The map with the findings of a diagnosis taken out of the recordings, beside that without."""
    causes = folder / "causes.toml"
    result, message, _, seconds = abbe(program, "diagnose", *world.write_all(folder), "--machine", MACHINE,
                                       "-o", causes)
    if result is None:
        return {"verdict": "refused", "message": message, "wrong": []}
    found = judge.diagnosis(result, world.effect)
    plain = map_of(program, world, folder)
    corrected = map_of(program, world, folder, "--causes", causes) if causes.exists() else {"map": "no causes"}
    both = [m["volume"] for m in (plain, corrected) if "volume" in m]
    worse = len(both) == 2 and both[1]["rms"] > both[0]["rms"] + judge.K95 * both[1]["u"]
    return {**found, "without": plain, "with": corrected, "worse": worse, "seconds": seconds}


def one(job, program, task, wide=False):
    """One world, from its seed to its line in the results."""
    seed, name = job
    world = World(seed, MACHINE, {**EFFECTS, **USUAL}.get(name), wide)
    line = {"seed": seed, "effect": name, "says": world.effect.says if world.effect else ""}
    if world.effect:
        moved = changes(world, World(seed, MACHINE, wide=wide))
        line["size_sd"] = round(sum(v**2 for v in moved.values()) ** 0.5, 1)
        line["touched"] = [run for run, v in moved.items() if v > 3]
    with tempfile.TemporaryDirectory() as folder:
        line.update(task(program, world, pathlib.Path(folder)))
    if "blamed" in line:
        guilty = [] if not world.effect or {"machine", "form"} & set(world.hooks) else line["touched"]
        innocent = lambda b: not any(run in b for run in guilty)
        line["innocent"] = [b for b in line["blamed"] if innocent(b) and
                            (b not in line["may_be_wrong"] or all(map(innocent, line["may_be_wrong"])))]
    return line


def jobs_of(effect, worlds, seed):
    names = {"all": list(EFFECTS), "usual": list(USUAL)}.get(effect, [effect])
    return [(seed + i, names[i % len(names)]) for i in range(worlds)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--abbe", help="the program")
    parser.add_argument("--worlds", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--effect", default="all", choices=["all", "usual", "clean", *EFFECTS, *USUAL])
    parser.add_argument("--wide", action="store_true", help="with gap steps and the target mounted a second time")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, help="lines are added to it")
    parser.add_argument("--map", action="store_true", help="coverage of fuse and reduce")
    parser.add_argument("--circles", action="store_true", help="the slow circles are in the map too")
    parser.add_argument("--apply", action="store_true", help="fuse with the causes of a diagnosis")
    parser.add_argument("--table", type=pathlib.Path, help="only print the table of such a file")
    given = parser.parse_args()
    if given.table:
        return print(table.of([json.loads(line) for line in given.table.read_text().splitlines()]))
    if not given.abbe:
        parser.error("--abbe is required")
    of_map = functools.partial(mapped, names=MAPPED + SLOW_CIRCLES) if given.circles else mapped
    task = of_map if given.map else applied if given.apply else diagnosed
    lines = []
    with multiprocessing.Pool(given.jobs) as pool:
        work = functools.partial(one, program=given.abbe, task=task, wide=given.wide)
        for line in pool.imap_unordered(work, jobs_of(given.effect, given.worlds, given.seed)):
            lines.append(line)
            if given.out:
                with given.out.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(line) + "\n")
    return print(table.of(lines))


if __name__ == "__main__":
    main()
