#!/usr/bin/env python3
"""Every command that reads a file, on files that were damaged: nothing may come of it but a result or one line.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml mutation_test.py
    ABBE_MUTATIONS=100 ABBE_MUTATION_SEED=7 ...    many more of them, other ones

Each file is damaged in the ways of KINDS. The program must end by itself with an exit code of 0 to 4, in bounded
time and memory; a refusal is one line that names the file and says nothing of C++; and only a result that was asked
for is left behind.
"""
import fnmatch
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import unittest
import urllib.request

from mutation_jobs import JOBS, NO_JOB, make_inputs
from program_case import PROGRAM

PER_FILE = int(os.environ.get("ABBE_MUTATIONS", "2"))  # of each command and file
SEED = int(os.environ.get("ABBE_MUTATION_SEED", "1"))
CPU_S = 60
MEMORY = 4 << 30

# What a person never reads.
INTERNAL = ("bad_alloc", "boost::", "std::", "vector::", "basic_string", "json.exception", "terminate called", "stod",
            "stoi", "Assertion", "map::at", "out_of_range")
# Files without lines.
NO_LINES = (".h5", ".db")
# Refusals of a file as a whole, which has no line to name.
WHOLE_FILE = {
    "something is missing":
        r"is missing|has no (\[limits\]|table|column|device|row|line of such names|result)|no result|holds no errors|"
        r"no deviations in|does not state its axis|is the axis there\?",
    "it is another file":
        r"is no diagnosis of|is not the result of|is no journal|does not state its quantities|this store asks|"
        r"a log of CAN traffic has|exists already",
    "it ends too early": r"truncated|is empty|no world is in it|needs a campaign",
    "the parser of JSON does not say where": r"contains a number beyond 1e308",
    "all its rows together":
        r"stations were approached|ISO 230-2: |poses give .* numbers|stand on one line|is no circle|fix no circle|"
        r"go round one of|of 360 degrees|have points: a square|does not go where the instrument saw it|"
        r"the noise of the reference is not known|a clock jumped back|--course |"
        r"a row (lacks|has)|information |goes from",
}
# Written in place of a number.
NUMBERS = (b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"-1", b"0", b"99999999999999999999", b"1e400", b"",
           b"2147483648", b"1,5")


def lines_of(data):
    return data.splitlines(keepends=True)


def flip_bits(data, draw):
    data = bytearray(data)
    for _ in range(draw.randint(1, 4)):
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    return bytes(data)


def cut(data, draw):
    return data[:draw.randrange(len(data))]


def double_a_line(data, draw):
    lines = lines_of(data)
    at = draw.randrange(len(lines))
    return b"".join(lines[:at + 1] + lines[at:])


def leave_out_a_line(data, draw):
    lines = lines_of(data)
    at = draw.randrange(len(lines))
    return b"".join(lines[:at] + lines[at + 1:])


def crlf(data, draw):
    return data.replace(b"\n", b"\r\n")


def byte_order_mark(data, draw):
    return b"\xef\xbb\xbf" + data


def put_nul(data, draw):
    at = draw.randrange(len(data))
    return data[:at] + b"\0" + data[at:]


def another_number(data, draw):
    """In place of a run of digits."""
    places = [i for i in range(len(data)) if 48 <= data[i] < 58]
    if not places:
        return flip_bits(data, draw)
    first = last = draw.choice(places)
    while first > 0 and data[first - 1:first] in b"0123456789.-":
        first -= 1
    while last < len(data) and data[last:last + 1] in b"0123456789.":
        last += 1
    return data[:first] + draw.choice(NUMBERS) + data[max(last, first + 1):]


def swap_pieces(data, draw):
    first, second = sorted(draw.randrange(len(data)) for _ in range(2))
    return data[second:] + data[first:second] + data[:first]


KINDS = (flip_bits, another_number, double_a_line, another_number, leave_out_a_line, put_nul, another_number, crlf,
         byte_order_mark, swap_pieces, flip_bits)


def path_of(folder, copy, path):
    """The file of `folder` that became `path` where `folder` was copied to `copy`."""
    return folder / path.relative_to(copy) if path != copy else folder


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def words_of(job):
    return [word.replace(".", " ") if word.startswith("[w") else word.replace("{out}", "new")
            for word in job.words.split()]


def subcommands(words=()):
    """All that the program has, by its own help: "rig record"."""
    text = subprocess.run([PROGRAM, *words, "--help"], capture_output=True, text=True, timeout=60).stdout
    found = {" ".join(words)} if words else set()
    if "\nSubcommands:\n" in text:
        for line in text.split("\nSubcommands:\n")[1].splitlines():
            if name := re.match(r"  ([a-z-]+)(\s|$)", line):
                found |= subcommands((*words, name[1]))
    return found


class MutationTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        parts = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, timeout=60).stdout
        cls.has = lambda part: f"{part}: yes" in parts
        cls.jobs = [job for job in JOBS if not job.without or cls.has(job.without)]
        make_inputs(cls.folder, cls.abbe, cls.has)

    @classmethod
    def abbe(cls, *words):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=cls.folder, capture_output=True, text=True, timeout=250)
        if done.returncode != 0:
            raise AssertionError(f"{words}: {done.stderr}")

    def files(self):
        return {path: path.stat().st_mtime_ns for path in self.folder.rglob("*") if path.is_file()}

    def serve(self, process):
        """Of a server: what a browser or a device asks for, then the end."""
        said = b""
        for line in process.stderr if "live" in process.args else process.stdout:
            said += line
            if page := re.search(rb"live page: http://([\d.]+):(\d+)/", line):
                url = f"http://{page[1].decode()}:{page[2].decode()}/events"
                with urllib.request.urlopen(url, timeout=60) as events:
                    while not events.readline().startswith((b"event: state", b"event: end")):
                        pass
            if b"live page" in line or b"listening" in line:
                process.send_signal(signal.SIGTERM)
                break
        _, error = process.communicate(timeout=10 * CPU_S)
        return subprocess.CompletedProcess(process.args, process.returncode, b"", said + error)

    def run_job(self, job):
        for name, copy in job.into.items():
            to = self.folder / copy.replace("{out}", "new")
            (shutil.copytree if (self.folder / name).is_dir() else shutil.copy2)(self.folder / name, to)
        how = {"cwd": self.folder, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "preexec_fn": limits,
               "env": {**os.environ, "OPENBLAS_NUM_THREADS": "1", "XDG_DATA_HOME": str(self.folder / "home")}}
        if job.serves:
            with subprocess.Popen([PROGRAM, *words_of(job)], **how) as process:
                return self.serve(process)
        return subprocess.run([PROGRAM, *words_of(job)], timeout=10 * CPU_S, stdin=subprocess.DEVNULL, **how)

    def clear(self, before):
        """What a run left and the copies that it worked in."""
        for path in self.files().keys() - before.keys():
            path.unlink()
        shutil.rmtree(self.folder / "new", ignore_errors=True)

    def changed(self, job, before):
        """Names of files that are new or not what they were; of a copy that is worked in, those that differ."""
        changed = set()
        for path, when in self.files().items():
            if before.get(path) == when:
                continue
            source = next((path_of(self.folder / name, self.folder / copy.replace("{out}", "new"), path)
                           for name, copy in job.into.items()
                           if path.is_relative_to(self.folder / copy.replace("{out}", "new"))), None)
            if source is None or not source.exists() or source.read_bytes() != path.read_bytes():
                changed.add(str(path.relative_to(self.folder)))
        return changed

    def judge(self, job, name, done, before):
        """What is wrong with this run, or nothing."""
        error = done.stderr.decode(errors="replace")
        changed = self.changed(job, before)
        if not 0 <= done.returncode <= 4:
            return f"ended with {done.returncode}: {error}"
        for word in INTERNAL:
            if word in error:
                return f"says {word}: {error}"
        if done.returncode in (0, 1):
            allowed = [output.replace("{out}", "new") for output in (*job.outputs, *job.into.values())]
            beside = [each for each in changed if not any(fnmatch.fnmatch(each, name) for name in allowed)]
            return f"left {beside}" if beside else None
        if done.returncode in job.ends:
            return f"left {changed}" if changed else None
        stores = {copy.replace("{out}", "new") for copy in job.into.values()} if job.keeps_a_store else set()
        if changed - stores:
            return f"refused, but left {changed}"
        refusal = ([line for line in error.splitlines() if line.strip()][-1:] or [""])[0]
        if not refusal.startswith("abbe: "):
            return f"no line of its own: {error}"
        return self.judge_refusal(job, name, refusal) if done.returncode == 2 else None

    def judge_refusal(self, job, name, refusal):
        own = pathlib.Path(name).name
        if name in job.into:
            own = pathlib.Path(job.into[name].replace("{out}", "new")).name
        # A report names the folder in which it found no result.
        names = any(other in refusal for other in (own, *job.names))
        if not names and f"abbe: {pathlib.Path(name).parent}:" not in refusal:
            return f"does not name the file: {refusal}"
        if pathlib.Path(name).suffix in NO_LINES or re.search(r":\d+: |\b(line|row|byte) \d+", refusal):
            return None
        if any(re.search(words, refusal) for words in WHOLE_FILE.values()):
            return None
        return f"does not say where: {refusal}"

    def test_every_subcommand_has_a_job_or_a_reason(self):
        all_of_them = subcommands()
        self.assertGreater(len(all_of_them), 30)
        for command in sorted(all_of_them):
            # Those that only hold others stand for them.
            is_group = any(other.startswith(command + " ") for other in all_of_them)
            has_job = any(f"{job.words} ".startswith(command + " ") for job in JOBS)
            self.assertTrue(has_job or command in NO_JOB or is_group, f"abbe {command}: no job")
            self.assertFalse(has_job and command in NO_JOB, f"abbe {command}: a job and a reason against it")
        for command in NO_JOB:
            self.assertIn(command, all_of_them)

    def test_the_jobs_are_good(self):
        for job in self.jobs:
            with self.subTest(job.words):
                before = self.files()
                done = self.run_job(job)
                self.clear(before)
                self.assertIn(done.returncode, job.ends, done.stderr.decode())

    def test_nothing_comes_of_damage_but_a_result_or_one_line(self):
        runs, whole_files = 0, {}
        for number, job in enumerate(self.jobs):
            for which, name in enumerate(job.damaged):
                whole = (self.folder / name).read_bytes()
                for i in range(PER_FILE):
                    draw = random.Random(f"{SEED} {number} {name} {i}")
                    # A file is cut once at least, and each job begins elsewhere in KINDS.
                    kind = cut if i == 0 else KINDS[(i + (PER_FILE - 1) * (number + which)) % len(KINDS)]
                    (self.folder / name).write_bytes(kind(whole, draw))
                    before = self.files()
                    with self.subTest(job.words, file=name, kind=kind.__name__, number=i):
                        wrong = self.judge(job, name, self.run_job(job), before)
                        if wrong:
                            self.fail(wrong)
                    runs += 1
                    self.clear(before)
                (self.folder / name).write_bytes(whole)
        print(f"{runs} damaged files")


if __name__ == "__main__":
    unittest.main()
