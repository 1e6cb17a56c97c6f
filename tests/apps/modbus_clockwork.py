"""A Modbus device whose registers tell when they were read, and a proxy that spoils its replies.

Clockwork counts its readings: register 0 holds the number n of the reading, register 1 a mark that only
this n has (MARK), so that a reply that is cut, mixed or of another request shows, and `when` the moment of
each reading, by the clock that abbe's stamps come from. TcpDevice and RtuDevice serve it; a Spoiler between
device and wire delays, drops, splits, doubles and corrupts replies. None of it is abbe's code.
"""
import os
import pty
import random
import socket
import struct
import threading
import time
import tty


def now():
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def mark(n):
    return (n * 40503 + 12345) % 65536


class Clockwork:
    def __init__(self):
        self.n, self.when, self.lock = 0, {}, threading.Lock()

    def answer(self, request):
        """The reply from the unit on to a request from the unit on."""
        unit, function = request[0], request[1]
        if function not in (3, 4):
            return bytes([unit, function | 0x80, 1])
        address, count = struct.unpack(">HH", request[2:6])
        with self.lock:
            self.n += 1
            self.when[self.n] = now()
            registers = [self.n % 65536, mark(self.n % 65536), 7, 8]
        words = registers[address:address + count]
        return struct.pack(f">BBB{len(words)}H", unit, function, 2 * len(words), *words)


class Spoiler:
    """Does one of its deeds to a share of the replies."""
    DEEDS = ("late", "dropped", "split", "doubled", "corrupt", "shortened", "stale")

    def __init__(self, seed, share, late_s=0.15, corruptible=None):
        self.random, self.share, self.late_s, self.corruptible = random.Random(seed), share, late_s, corruptible
        self.last, self.done = b"", {deed: 0 for deed in self.DEEDS}
        self.well = 10  # replies before the first deed: a device must answer at the start

    def spoil(self, reply, send):
        self.well -= 1
        deed = self.random.choice(self.DEEDS) if self.well < 0 and self.random.random() < self.share else None
        before, self.last = self.last, reply
        if deed is None:
            return send(reply)
        self.done[deed] += 1
        if deed == "dropped":
            return None
        if deed == "late":
            time.sleep(self.late_s * self.random.random())
        elif deed == "split":
            at = self.random.randrange(1, len(reply))
            send(reply[:at])
            time.sleep(0.02 * self.random.random())
            return send(reply[at:])
        elif deed == "doubled":
            send(reply)
            time.sleep(0.003 * self.random.random())
        elif deed == "corrupt":
            spoiled = bytearray(reply)
            spoiled[self.random.randrange(self.corruptible or len(reply))] ^= 1 << self.random.randrange(8)
            return send(bytes(spoiled))
        elif deed == "shortened":
            return send(reply[:self.random.randrange(1, len(reply))])
        elif deed == "stale":
            return send(before or reply)  # the answer to the request before
        return send(reply)


def plain(reply, send):
    send(reply)


class TcpDevice:
    def __init__(self, device, spoil=plain):
        self.device, self.spoil = device, spoil
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            client = self.listener.accept()[0]
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        with client, client.makefile("rb") as stream:
            while len(head := stream.read(6)) == 6:
                reply = self.device.answer(stream.read(struct.unpack(">H", head[4:])[0]))
                try:
                    self.spoil(head[:4] + struct.pack(">H", len(reply)) + reply, client.sendall)
                except OSError:
                    return


def crc(data):
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value >> 1) ^ (0xA001 if value & 1 else 0)
    return struct.pack("<H", value)


class RtuDevice:
    def __init__(self, device, spoil=plain):
        self.device, self.spoil = device, spoil
        self.ours, self.theirs = pty.openpty()
        tty.setraw(self.ours)
        tty.setraw(self.theirs)
        self.name = os.ttyname(self.theirs)
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        got = b""
        while True:
            got += os.read(self.ours, 256)
            while len(got) >= 7:
                length = 7 if got[1] == 43 else 8
                if len(got) < length:
                    break
                frame, got = got[:length], got[length:]
                if crc(frame[:-2]) != frame[-2:]:
                    got = b""
                    break
                reply = self.device.answer(frame[:-2])
                self.spoil(reply + crc(reply), lambda data: os.write(self.ours, data))


if __name__ == "__main__":  # a device in a process of its own, which can be stopped
    server = TcpDevice(Clockwork())
    print(server.port, flush=True)
    threading.Event().wait()
