#!/usr/bin/env python3
"""Three encoders of the virtual rig, asked by `abbe record` at 1 kHz SYNC: is every SYNC answered three times and
recorded, how evenly do they come, and what does it cost?

    ABBE=path/to/abbe uml_run -- python3 can_rate.py [SECONDS]

A third party counts: sockets with one filter each, which nobody reads during the run. The kernel counts what they
match, and the one for SYNC keeps every frame with the kernel's stamp. Exit status 1 when anything was lost.
"""
import csv
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

ABBE = os.environ["ABBE"]
MILL = pathlib.Path(__file__).parents[1] / "machines" / "demo_mill.toml"
SYNC, PDOS = 0x080, (0x181, 0x182, 0x183)
SO_RCVBUFFORCE, SO_TIMESTAMPNS = 33, 35
EXACTLY = socket.CAN_SFF_MASK | socket.CAN_EFF_FLAG | socket.CAN_RTR_FLAG


def witness(identifier, size):
    """A socket that keeps the frames with this identifier, as many as `size` bytes hold."""
    listener = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    listener.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=II", identifier, EXACTLY))
    listener.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, size)
    listener.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
    listener.bind(("vcan0",))
    listener.setblocking(False)
    return listener


def matches():
    """How many frames each filter of the kernel has matched."""
    counts = {}
    for line in pathlib.Path("/proc/net/can/rcvlist_sff").read_text().splitlines():
        words = line.split()
        if len(words) == 7 and words[0] == "vcan0":
            counts[int(words[1], 16)] = int(words[5])
    return counts


def stamps(listener):
    times = []
    while True:
        try:
            _, extra, _, _ = listener.recvmsg(16, 64)
        except BlockingIOError:
            return times
        seconds, nanoseconds = struct.unpack("qq", extra[0][2])
        times.append((seconds, nanoseconds))


def describe(folder):
    text = MILL.read_text()
    for pattern, put in ((r"(?m)^rate_hz = .*", "rate_hz = 1000.0"), (r"(?m)^stale_ms = .*", "stale_ms = 5000.0"),
                         # rate_hz sets the pace, sync_ms only the least distance. The guest has one virtual
                         # processor, which the whole computer shares.
                         (r"(?m)^sync_ms = .*",
                          "sync_ms = 0.5\nanswer_timeout_ms = 1000.0\nheartbeat_timeout_ms = 5000.0")):
        text, count = re.subn(pattern, put, text)
        assert count == 1, pattern
    machine = folder / "machine.toml"
    machine.write_text(text)
    return machine


def serve(machine, folder, seconds):
    passes = str(1 + int(seconds / 38))  # both ways round take 38 s
    ready = folder / "port"
    rig = subprocess.Popen([ABBE, "rig", "--machine", machine, "--ready-file", ready, "--can", "vcan0", "--course",
                            "circle", "--passes", passes, "--start", "course"], stdout=subprocess.DEVNULL)
    while not ready.exists():
        assert rig.poll() is None, "the rig ended before it was ready"
        time.sleep(0.05)
    return rig


def finish(process):
    """Waits for a process; its exit status and the processor time that it took, s."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime


def main(seconds):
    folder = pathlib.Path(tempfile.mkdtemp())
    machine, out = describe(folder), folder / "angles.csv"
    syncs_heard = witness(SYNC, 96 << 20)
    listeners = [witness(pdo, 1 << 10) for pdo in PDOS]
    rig = serve(machine, folder, seconds)
    begun = time.monotonic()
    record = subprocess.Popen([ABBE, "record", machine, "--devices", "linkage", "--seconds", str(seconds), "--quiet",
                               "-o", out])
    status, record_cpu = finish(record)
    lasted = time.monotonic() - begun
    rig.send_signal(signal.SIGTERM)
    rig_status, rig_cpu = finish(rig)
    assert (status, rig_status) == (0, 0), (status, rig_status)

    heard, counted = stamps(syncs_heard), matches()
    rows = list(csv.DictReader(line for line in out.read_text().splitlines() if not line.startswith("#")))
    flagged = sum(row["flags"] != "0" for row in rows)
    recorded = heard[-len(rows):]  # those before were sent while the nodes were started
    times = [s - recorded[0][0] + 1e-9 * (ns - recorded[0][1]) for s, ns in recorded]
    gaps = [1e3 * (b - a) for a, b in zip(times, times[1:])]
    jitter = sorted(abs(gap - 1.0) for gap in gaps)
    # The SYNCs on the bus and the rows are one and the same when the first and the last are equally far apart.
    apart = 1e3 * abs(times[-1] - (float(rows[-1]["time_s"]) - float(rows[0]["time_s"])))

    print(f"SYNC: {counted[SYNC]} on the bus in {lasted:.1f} s, {counted[SYNC] - len(rows)} of them to start the "
          f"nodes; {len(rows)} recorded, {flagged} flagged")
    print("PDO: " + ", ".join(f"{counted[pdo]} of node {node}" for node, pdo in enumerate(PDOS, 1)))
    print(f"SYNC to SYNC: {sum(gaps) / len(gaps):.3f} ms; off 1 ms by {sum(jitter) / len(jitter):.3f} ms on average, "
          f"99 % by less than {jitter[int(0.99 * len(jitter))]:.3f} ms, at most {jitter[-1]:.3f} ms")
    print(f"processor: abbe record {100 * record_cpu / lasted:.1f} %, abbe rig {100 * rig_cpu / lasted:.1f} %")
    faults = []
    if len(heard) != counted[SYNC]:
        faults.append(f"the witness kept {len(heard)} of {counted[SYNC]} SYNCs")
    if flagged or any(counted[pdo] < len(rows) for pdo in PDOS):
        faults.append("a SYNC was not answered three times")
    if apart > 0.5:
        faults.append(f"a SYNC was not recorded: bus and recording differ by {apart:.3f} ms")
    print("\n".join(faults) if faults else "every SYNC sent was answered three times and recorded")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
