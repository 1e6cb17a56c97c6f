"""The commands of mutation_test.py: what each reads, and the files that are damaged."""
import dataclasses
import json
import pathlib
import random
import shutil

from certificate_case import DATA
from map_machine import MapMachine
from program_case import MACHINE


@dataclasses.dataclass
class Job:
    """A command line; its files stand in the folder, outputs are those that it may leave.

    into: copies that it works in, where it changes what it reads: {"file or folder": "its name in the words"}.
    without: a part that a build may lack, and whose command is then not there.
    ends: the exit code on whole files. 3: no device answers. A server (serves) runs until it is stopped.
    names: what a refusal may name instead: the program at the line that takes a number from a table, the machine file
    in a history, a parameter that contradicts its tolerance.
    keeps_a_store: a study or a fleet, which drops a row that was cut off and keeps what it worked out.
    """
    words: str
    damaged: tuple
    outputs: tuple = ()
    into: dict = dataclasses.field(default_factory=dict)
    without: str = ""
    ends: tuple = (0, 1)
    names: tuple = ()
    serves: bool = False
    keeps_a_store: bool = False


IN_HISTORY = ("mill.toml",)  # kept in it, under its name
JOBS = (
    Job("init --check mill.toml", ("mill.toml",)),
    Job("init --kind mill --positive carriage --ini mill.ini --out {out}.toml", ("mill.ini",), ("{out}.toml",)),
    Job("doctor --machine mill.toml --readings 2 --out empty", ("mill.toml",), ends=(3,)),
    Job("rig --machine mill.toml --port 0", ("mill.toml",), serves=True),
    Job("align --axis X --machine mill.toml --out {out}", ("mill.toml", "aligned/mounting.toml"), (),
        {"aligned": "{out}"}, ends=(3,)),
    Job("sweep --axis X --machine mill.toml --out {out}", ("mill.toml", "aligned/mounting.toml"), (),
        {"aligned": "{out}"}, ends=(3,)),
    Job("record mill.toml --seconds 0.1 -o {out}.csv", ("mill.toml",), ("{out}.csv",), ends=(3,)),
    Job("convert sweep.csv {out}.h5", ("sweep.csv",), ("{out}.h5",)),
    Job("convert sweep.h5 {out}.csv", ("sweep.h5",), ("{out}.csv",)),
    Job("convert targets.dat {out}.csv", ("targets.dat",), ("{out}.csv",)),
    Job("convert laser.rtl {out}.csv", ("laser.rtl",), ("{out}.csv",)),
    Job("convert ballbar.csv {out}.csv --ballbar-mm 150 --column angle_deg=angle --column deviation_um=deviation",
        ("ballbar.csv",), ("{out}.csv",)),
    Job("convert holes.txt {out}.csv --probing-um 3", ("holes.txt",), ("{out}.csv",)),
    Job("convert table.csv {out}.csv --column shaft_deg=counts*0.005 --column gap_1_mm=gap --kind shaft",
        ("table.csv",), ("{out}.csv",)),
    Job("convert monitor.log {out}.csv --column gap_mm=W:gap --column shaft_deg=W:angle", ("monitor.log",),
        ("{out}.csv",)),
    Job("convert can.log {out}.csv --machine mill.toml", ("can.log", "mill.toml"), ("{out}.csv",)),
    Job("convert angles.csv {out}.log --machine mill.toml", ("angles.csv",), ("{out}.log",)),
    Job("reduce sweep.csv --machine mill.toml --json {out}.json", ("sweep.csv", "mill.toml"), ("{out}.json",)),
    Job("reduce sweep.h5 --machine mill.toml --json {out}.json", ("sweep.h5",), ("{out}.json",)),
    Job("reduce sweep.csv --machine mill.toml --causes causes.toml --json {out}.json", ("causes.toml",),
        ("{out}.json",)),
    Job("reduce targets.csv --json {out}.json", ("targets.csv",), ("{out}.json",)),
    Job("circle circle.csv --json {out}.json", ("circle.csv",), ("{out}.json",)),
    Job("harmonics turn.csv --angle shaft_deg --of gap_mm --json {out}.json", ("turn.csv",), ("{out}.json",)),
    Job("follow warm.csv --value gap_mm --json {out}.json", ("warm.csv",), ("{out}.json",)),
    Job("calibrate cube.csv --machine mill.toml --folds 1 -o {out}.toml", ("cube.csv",), ("{out}.toml",)),
    Job("calibrate cube.csv --machine mill.toml --folds 1 --compare --check linkage.csv --json {out}.json",
        ("linkage.csv",), ("{out}.json",)),
    Job("calibrate poses.csv --check other_poses.csv --machine arm.toml -o {out}.toml --json {out}.json",
        ("poses.csv", "other_poses.csv", "arm.toml"), ("{out}.toml", "{out}.json"), names=("calibration: ",)),
    Job("circle linkage.csv --machine mill.toml --calibration linkage.toml --json {out}.json", ("linkage.toml",),
        ("{out}.json",)),
    Job("path square.csv --machine mill.toml --test square --json {out}.json", ("square.csv",), ("{out}.json",)),
    Job("path square.csv --machine mill.toml --test path.csv --json {out}.json", ("path.csv",), ("{out}.json",)),
    Job("diagnose sweep.csv --machine mill.toml -o {out}.toml --json {out}.json", ("sweep.csv", "mill.toml"),
        ("{out}.toml", "{out}.json")),
    Job("diagnose --plan circle.csv --machine mill.toml --json {out}.json", ("circle.csv",), ("{out}.json",)),
    Job("diagnose axis.csv --machine one_axis.toml --learn --learned learned.toml --json {out}.json",
        ("learned.toml", "axis.csv"), ("{out}.json",)),
    Job("learned name {out}.toml 1 --name cover-drag", ("learned.toml",), (), {"learned.toml": "{out}.toml"}),
    Job("investigate --machine mill.toml --out {out} --budget 40min --devices", ("begun/investigation.json",),
        ("{out}/*",), {"begun": "{out}"}),
    Job("fuse sweep.csv --machine mill.toml --fixed-smoothness -o {out}.toml --json {out}.json",
        ("sweep.csv", "mill.toml"), ("{out}.toml", "{out}.json")),
    Job("fuse sweep.csv --machine mill.toml --fixed-smoothness --causes causes.toml -o {out}.toml", ("causes.toml",),
        ("{out}.toml",)),
    Job("track fused.toml --machine drift.toml --at 30,30,30 --time 2100-01-01T00:00:00Z --temperature column=21 "
        "--json {out}.json", ("fused.toml", "drift.toml"), ("{out}.json",)),
    Job("track fused.toml later.csv --machine drift.toml -o {out}.toml", ("later.csv",), ("{out}.toml",)),
    Job("plate holes.csv --machine mill.toml -o {out}.toml", ("holes.csv",), ("{out}.toml",)),
    Job("export map.toml --format csv --points 3 --out {out}.csv", ("map.toml",), ("{out}.csv",)),
    Job("export map.isg --chain [w.X.Y.b.Z.t] --format csv --points 3 --out {out}.csv", ("map.isg",), ("{out}.csv",)),
    Job("export map.etalon --chain [w.X.Y.b.Z.t] --format csv --points 3 --out {out}.csv", ("map.etalon",),
        ("{out}.csv",)),
    Job("simulate map.toml --test freeform --path path.csv --json {out}.json", ("path.csv",), ("{out}.json",)),
    Job("simulate map.toml --test circle --causes squareness.toml --json {out}.json", ("squareness.toml",),
        ("{out}.json",)),
    Job("correct map.toml points.csv --out {out}.csv", ("points.csv",), ("{out}.csv",)),
    Job("correct map.toml part.ngc --start 30,30,30 --out {out}.ngc", ("part.ngc",), ("{out}.ngc",)),
    Job("correct map.toml tools.ngc --start 30,30,50 --tool 0,0,-80 --parameters mill.var --tools mill.tbl "
        "--ini mill.ini --out {out}.ngc", ("mill.var", "mill.tbl", "mill.ini", "tools.ngc"), ("{out}.ngc",),
        names=("tools.ngc",)),
    Job("certificate fused.toml --result fused.json --machine drift.toml --data lab.toml --diagnosis diagnosis.json "
        "--points 3 -o {out}.xml", ("fused.toml", "fused.json", "lab.toml", "diagnosis.json"), ("{out}.xml",),
        without="certificates"),
    Job("study head --machine mill.toml --worlds 4 --store {out}.jsonl --resume", ("head.jsonl", "mill.toml"), (),
        {"head.jsonl": "{out}.jsonl"}, keeps_a_store=True),
    Job("study show head.jsonl", ("head.jsonl",)),
    Job("study merge head.jsonl more.jsonl -o {out}.jsonl", ("more.jsonl",), ("{out}.jsonl",)),
    Job("fleet fit --machine mill.toml --store {out}.jsonl --resume --json {out}.json", ("fleet.jsonl",),
        ("{out}.json",), {"fleet.jsonl": "{out}.jsonl"}, keeps_a_store=True),
    Job("history add results --machine mill.toml --store {out}.db", ("results/sweep.json",), ("{out}.db",),
        without="history"),
    Job("history list --store {out}.db", ("history.db",), (), {"history.db": "{out}.db"}, without="history",
        names=IN_HISTORY),
    Job("history show latest --store {out}.db --json {out}.json", ("history.db",), ("{out}.json",),
        {"history.db": "{out}.db"}, without="history", names=IN_HISTORY),
    Job("history export --format json --store {out}.db", ("history.db",), (), {"history.db": "{out}.db"},
        without="history"),
    Job("history compare 1 2 --store {out}.db", ("history.db",), (), {"history.db": "{out}.db"}, without="history",
        names=IN_HISTORY),
    Job("history trend EYX --store {out}.db", ("history.db",), (), {"history.db": "{out}.db"}, without="history",
        names=IN_HISTORY),
    Job("history check results --machine drift.toml --store {out}.db", ("results/sweep.json", "drift.toml"),
        ("{out}.db",), without="history"),
    Job("history forget latest --store {out}.db", ("history.db",), (), {"history.db": "{out}.db"}, without="history",
        names=IN_HISTORY),
    Job("report results --out {out}.html", ("results/sweep.json",), ("{out}.html",)),
    Job("live results --live-port 0", ("results/sweep.json",), without="live page", serves=True),
    Job("rig compare truth.json results/sweep.json", ("truth.json", "results/sweep.json")),
    Job("rig record --machine mill.toml --course path.csv --out {out}.csv", ("path.csv",), ("{out}.csv",)),
    Job("sensitivity --linkage mill.toml --draws 16 --points 2 --json {out}.json", ("mill.toml",), ("{out}.json",)),
)

# The subcommands without a job.
NO_JOB = {
    "causes": "reads no file",
    "completion": "reads no file",
    "man": "reads no file",
    "study hidden": "reads as study head does",
    "study circle": "reads as study head does",
}

DRIFT = """
[limits]
EYX = { straightness_um = 1.0 }
[drift]
straightness_um = 0.05
pitch_urad = 1.0
yaw_urad = 1.0
roll_urad = 1.0
smoothness_mm = 30.0
[drift.temperature.column]
lag_s = 3600.0
"""
ARM = """name = "small-arm"
[linkage]
form = "denavit-hartenberg"
joint = [{ d_mm = 300, alpha_deg = -90 }, { a_mm = 350 }, { a_mm = 300 }]
[linkage.base]
position_mm = [0.0, 0.0, 0.0]
[linkage.tolerance]
link_um = 1000
ball_um = 1000
pivot_urad = 1000
encoder_offset_urad = 2000
[linkage.noise]
encoder_urad = 2.0
reference_um = 5.0
"""
LEARNED = """# What the simulation of this machine lacked
extended_model = 1
machine = "demo-mill"
[diagnosis]
verdict = "learned"
[[learned]]
stage = "motion"
object = "X"
expression = "feed^2"
coefficients_um = [1e-5]
covariance = [1e-22]
[learned.certificate]
by_chance = 1e-7
heldout_rms_before = 1.42
heldout_rms_after = 1.01
regime = "holds"
"""


def arm_poses(seed):
    """Poses of the arm of ARM, computed here."""
    import numpy as np
    import arm_fit
    rows = [(0.0, 300.2, 0.1, -np.pi / 2, 0.0), (0.0, 0.0, 350.1, 0.0, 0.0), (0.0, 0.0, 299.8, 0.0, 0.0)]
    draw = np.random.default_rng(seed)
    q = draw.uniform(-2.0, 2.0, size=(24, 3))
    x = arm_fit.tips(rows, (0.0, 0.0, 0.0), q) + draw.normal(size=(24, 3)) * 5e-3
    return ('# abbe-recording = 1\n# kind = "linkage"\n# time = "order"\n'
            "time_s,pivot_1_rad,pivot_2_rad,pivot_3_rad,ref_x_mm,ref_y_mm,ref_z_mm\n" +
            "".join(f"{i}," + ",".join(f"{value:.6f}" for value in (*q[i], *x[i])) + "\n" for i in range(24)))


def write_tables(put):
    """What other programs write."""
    put("targets.dat", "UNIT=mm\nCYCLES=2\nPOSITIONS=3\n" + "".join(
        f"TGT_DATA[{i}]={10 * i}\n" + "".join(f"REF_DATA_{way}[{i},{j}]={10 * i + 0.001 * j}\n"
                                               for j in (1, 2) for way in ("FWD", "BWD")) for i in (1, 2, 3)))
    put("laser.rtl", "HEADER::\nFile type  : rtl\nTARGET DATA::\nTarget-count: 3\nTargets :\n0 100  200\n"
                     "Flags: 0 0 2 0\nUSER-TEXT::\nAxis:X\nRUNS::\nRun-count:2\nDEVIATIONS::\nRun Target Data:\n"
                     "1 1 0.5\n1 2 -1.25\n1 3 2\n2 3 3\n2 2 -0.25\n2 1 1.5\nEOF::\n")
    put("ballbar.csv", "angle,deviation\n" + "".join(f"{10 * i},{(i * 7) % 11 * 0.3:.2f}\n" for i in range(37)))
    put("holes.txt", "Plug Plate: 1597A\n    Meas X    Meas Y     Nom X     Nom Y\n" + "".join(
        f"   {10.1 * i:.3f}   {-9.9 * i:.3f}   {10 * i:.3f}   {-10 * i:.3f}\n" for i in range(1, 9)))
    put("table.csv", "counts,gap,note\n" + "".join(f"{100 * i},{0.5 + 0.001 * i},fine\n" for i in range(20)))
    put("monitor.log", "".join(f"W:angle 2026-11-21 09:00:{i:02}.000000 {12.5 * i}\n"
                               f"W:gap 2026-11-21 09:00:{i:02}.500000 {0.5 + 0.01 * i} HIGH\n" for i in range(40)))
    put("can.log", "".join(f"(17637168{i:02}.000000) vcan0 080#\n" + "".join(
        f"(17637168{i:02}.000{node}00) vcan0 18{node}#0{i % 10}000400\n" for node in (1, 2, 3)) for i in range(20)))
    put("part.ngc", "%\n(a part)\nG21 G90 G17\nG0 X10 Y10 Z20\nG1 Z10 F300\nG1 X20\nG2 X30 Y20 I0 J10\n"
                    "G3 X20 Y30 R10\nG91\nG1 X-5 Y1.5\nG90\nM2\n%\n")
    put("tools.ngc", "%\nG21 G90 G17 G54\nT3 M6\nG43 H3\nG0 X10 Y10 Z20\nG1 X[20+#31] F300\nG1 Y#<_ini[TOOLSENSOR]Y>\n"
                     "M2\n%\n")
    put("mill.var", "31\t1.5\n5220\t1\n5221\t12.5\n5222\t-3\n5223\t0\n5230\t0\n")
    put("mill.tbl", "T1 P1 D6 Z20.5 ;end mill\nT3 P3 Z-1.2 D2.5\n")
    put("mill.ini", "[EMC]\nMACHINE = a mill\n[KINS]\nKINEMATICS = trivkins\n[TRAJ]\nLINEAR_UNITS = mm\n" + "".join(
        f"[AXIS_{axis}]\nMIN_LIMIT = 0\nMAX_LIMIT = 60\n" for axis in "XYZ") + "[TOOLSENSOR]\nY = 12.5\n")


def write_recordings(put):
    """Recordings and paths, by hand."""
    put("turn.csv", '# abbe-recording = 1\n# kind = "dwell"\ntime_s,shaft_deg,gap_mm,flags\n' + "".join(
        f"{0.1 * i:.1f},{12 * i % 360},{0.5 + 0.01 * (i % 30)},0\n" for i in range(120)))
    put("angles.csv", '# abbe-recording = 1\n# kind = "dwell"\n# started = 2026-11-21T09:00:00Z\n'
                      "time_s,pivot_1_rad,pivot_2_rad,pivot_3_rad\n" + "".join(
                          f"{0.1 * i:.1f},{0.01 * i:.2f},{0.02 * i:.2f},{-0.01 * i:.2f}\n" for i in range(20)))
    draw = random.Random(3)
    put("warm.csv", '# abbe-recording = 1\n# kind = "dwell"\ntime_s,temp_column_c,gap_mm\n' + "".join(
        f"{60 * i},{20 + 2 * (1 - 0.97 ** i):.4f},{0.5 + 0.01 * (1 - 0.95 ** i) + draw.gauss(0, 1e-4):.6f}\n"
        for i in range(120)))
    put("path.csv", "x_mm,y_mm,z_mm\n" + "".join(f"{20 + i},{30 - i},{25 + 0.5 * i}\n" for i in range(8)))
    put("points.csv", "x_mm,y_mm,z_mm\n" + "".join(f"{20 + i},{30 - i},{25 + 0.5 * i}\n" for i in range(8)))
    put("poses.csv", arm_poses(1))
    put("other_poses.csv", arm_poses(2))


def write_settings(put):
    text = pathlib.Path(MACHINE).read_text().replace("step_mm = 1.0", "step_mm = 15.0").replace(
        "passes = 5", "passes = 2")
    put("mill.toml", text)
    put("drift.toml", text + DRIFT)
    put("lab.toml", DATA)
    put("arm.toml", ARM)
    put("one_axis.toml", 'name = "demo-mill"\nchain = "[w X b t]"\naxis.X.positive = "carriage"\n'
                         "axis.X.travel_mm = [0, 60]\n")
    put("learned.toml", LEARNED)
    put("causes.toml", 'extended_model = 1\nmachine = "demo-mill"\n'
                       '[[cause]]\nid = "probe-gain"\nobject = "probe_b"\ndelta = 0.05\n')
    put("squareness.toml", 'extended_model = 1\nmachine = "numpy-mill"\n'
                           '[[cause]]\nid = "squareness"\nobject = "XY"\nangle_urad = 12.0\n')
    put("aligned/mounting.toml", 'id = "first"\n[aligned.X]\nat = "2026-11-21T09:00:00Z"\ntop_tilt_urad = 3.0\n'
                                 "side_tilt_urad = -4.0\n")


def make_inputs(folder, abbe, has):
    """All files of JOBS; abbe runs the program, has(part) says whether the build has it."""
    def put(name, text):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)

    (folder / "empty").mkdir()
    (folder / "results").mkdir()
    write_settings(put)
    write_tables(put)
    write_recordings(put)
    record = lambda name, *words: abbe("rig", "record", "--machine", "mill.toml", "--out", name, *words)
    record("sweep.csv", "--axis", "X", "--rate", 20, "--truth", "truth.json")
    abbe("convert", "sweep.csv", "sweep.h5")
    record("later.csv", "--axis", "X", "--rate", 20, "--after-days", 7)
    record("cube.csv", "--course", "cube", "--points", "4,3,3", "--dwell", 0.01, "--reference", "--feed", 6000)
    record("linkage.csv", "--course", "circle", "--size", 10, "--rate", 20)
    record("circle.csv", "--course", "circle", "--size", 10, "--rate", 20, "--kind", "reference")
    record("square.csv", "--course", "square", "--kind", "reference", "--size", 10, "--rate", 20)
    record("holes.csv", "--plate")
    abbe("calibrate", "cube.csv", "--machine", "mill.toml", "--folds", 1, "-o", "linkage.toml", "--quiet")
    abbe("reduce", "sweep.csv", "--machine", "mill.toml", "--json", "results/sweep.json", "--quiet")
    abbe("reduce", "later.csv", "--machine", "mill.toml", "--json", "later/sweep.json", "--quiet")
    abbe("convert", "targets.dat", "targets.csv")
    first, rest = (folder / "targets.csv").read_text().split("\n", 1)
    put("axis.csv", f"{first}\n# u_reference_um = 0.5\n{rest}")
    MapMachine(7).write(folder / "map.toml")
    for form in ("isg", "etalon"):
        abbe("export", "map.toml", "--format", form, "--points", 7, "--out", f"map.{form}", "--quiet")
    abbe("fuse", "sweep.csv", "--machine", "drift.toml", "--fixed-smoothness", "-o", "fused.toml", "--json",
         "fused.json", "--quiet")
    abbe("investigate", "--machine", "mill.toml", "--out", "begun", "--budget", "40min", "--devices")
    abbe("study", "head", "--machine", "mill.toml", "--worlds", 3, "--store", "head.jsonl", "--quiet")
    abbe("study", "head", "--machine", "mill.toml", "--worlds", 3, "--seed", 11, "--store", "more.jsonl", "--quiet")
    (folder / "campaign").mkdir()
    shutil.copy(folder / "sweep.csv", folder / "campaign")
    abbe("fleet", "fit", "A=campaign", "--machine", "mill.toml", "--store", "fleet.jsonl", "--quiet")
    if has("history"):
        for folder_of_results in ("results", "later"):
            abbe("history", "add", folder_of_results, "--machine", "mill.toml", "--store", "history.db", "--quiet")
    put("diagnosis.json", json.dumps({
        "command": "diagnose", "machine": "demo-mill", "verdict": "unexplained",
        "unexplained": [{"variable": "time", "object": "X", "amplitude": 2.0, "unit": "um"}]}, indent=1))
