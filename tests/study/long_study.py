"""Runs a study of ABBE_SEEDS (1000) worlds, or the part ABBE_SHARD (k/n) of them, and fails where a bound is refuted.

    long_study.py PROGRAM STUDY VARIANT MACHINE FOLDER

The store in FOLDER goes on where an earlier run of the same question ended.
"""
import os
import pathlib
import subprocess
import sys

program, study, variant, machine, folder = sys.argv[1:]
shard = os.environ.get("ABBE_SHARD", "1/1")
name = f"{study}-{variant}" + ("" if shard == "1/1" else "-" + shard.replace("/", "-of-"))
pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
sys.exit(subprocess.run([program, "study", study, "--machine", machine, "--variant", variant, "--resume",
                         "--worlds", os.environ.get("ABBE_SEEDS", "1000"), "--shard", shard,
                         "--store", f"{folder}/{name}.jsonl"]).returncode)
