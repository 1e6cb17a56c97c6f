#!/usr/bin/env python3
"""CANopen encoders (CiA 406) on python-can, to be read by abbe: an independent peer.

can_encoders.py INTERFACE COUNTS_PER_TURN NODE...

Each node boots, beats every 50 ms, answers SDO reads, obeys NMT, and sends TPDO 1 at each SYNC: its
count is 1000 * node + 7 * the number of SYNCs since it was started, modulo the counts of a turn.
Prints "ready" once it listens.
"""
import struct
import sys
import time

import can

interface, per_turn, ids = sys.argv[1], int(sys.argv[2]), [int(word) for word in sys.argv[3:]]
bus = can.Bus(interface=("socketcan"), channel=interface)
state = dict.fromkeys(ids, 0x7F)
syncs = dict.fromkeys(ids, 0)
objects = {(0x6000, 0): 4, (0x6001, 0): per_turn, (0x6002, 0): per_turn}


def send(cob_id, data):
    bus.send(can.Message(arbitration_id=cob_id, data=data, is_extended_id=False), timeout=1.0)


def hear(message):
    if message.is_error_frame or message.is_extended_id:
        return
    data = bytes(message.data)
    if message.arbitration_id == 0x000 and len(data) == 2:
        for node in ids:
            if data[1] in (0, node) and data[0] in (1, 2, 128):
                state[node] = {1: 5, 2: 4, 128: 0x7F}[data[0]]
    elif message.arbitration_id == 0x080 and not data:
        for node in ids:
            if state[node] == 5:
                syncs[node] += 1
                send(0x180 + node, struct.pack("<I", (1000 * node + 7 * syncs[node]) % per_turn))
    elif message.arbitration_id - 0x600 in ids and len(data) == 8 and data[0] == 0x40:
        node = message.arbitration_id - 0x600
        index, sub = struct.unpack_from("<HB", data, 1)
        value = objects.get((index, sub))
        if value is None:
            send(0x580 + node, struct.pack("<BHBI", 0x80, index, sub, 0x06020000))
        else:
            send(0x580 + node, struct.pack("<BHBI", 0x43, index, sub, value))


for node in ids:
    send(0x700 + node, b"\0")
print("ready", flush=True)
beat = time.monotonic()
while True:
    try:
        message = bus.recv(max(0.0, beat - time.monotonic()))
        if message is not None:
            hear(message)
        if time.monotonic() >= beat:
            beat += 0.05
            for node in ids:
                send(0x700 + node, bytes([state[node]]))
    except (can.CanError, OSError):
        time.sleep(0.02)  # the interface is away
