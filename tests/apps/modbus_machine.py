"""A small machine with a five-probe head, served over Modbus TCP by code that is not abbe's.

Machine holds the physics (first-order equations of the head, stations, dwells). RawServer answers on
plain sockets and can misbehave on demand; PymodbusServer serves the same machine through pymodbus.
"""
import logging
import socket
import socketserver
import struct
import threading
import time

ARM, SIDE_HEIGHT = 10.0, 20.0  # mm: the layout of the demonstration machine
COUNTS_PER_UM = 1 / 0.0030517578125


TICK = 0.005  # s, of the machine's time: it goes on with each set that is read, 200 a second at most


class Machine:
    """Sweeps X over its stations, up and down, `passes` times, once it was started.

    Its time goes on as it is read, so that a busy computer makes the sweep longer and spoils nothing.
    """

    def __init__(self, stations=(0.0, 10.0, 20.0, 30.0), passes=2, dwell_s=0.25, move_s=0.05):
        self.stations, self.dwell_s, self.move_s = list(stations), dwell_s, move_s
        below, above = self.stations[0] - 0.5, self.stations[-1] + 0.5  # where the axis turns
        self.path = [below, *self.stations, above, *self.stations[::-1]] * passes + [below]
        self.ticks, self.controller_read = 0, False
        self.started = None
        self.frozen_at = None
        self.stop_after = None

    def start(self):
        self.started = self.ticks

    def time(self):
        now = 0.0 if self.started is None else TICK * (self.ticks - self.started)
        return now if self.stop_after is None else min(now, self.stop_after)

    def position(self):
        """mm; linear moves between the stations of the path."""
        leg = self.dwell_s + self.move_s
        index, within = divmod(max(self.time() - 0.1, 0.0), leg)
        index = int(index)
        if index + 1 >= len(self.path):
            return self.path[-1]
        share = max(within - self.dwell_s, 0.0) / self.move_s
        return self.path[index] + (self.path[index + 1] - self.path[index]) * share

    @staticmethod
    def errors(d):
        """The true errors at d mm: rad and um, zero at d = 0."""
        return {"EAX": 20e-6 * d / 30, "EBX": -30e-6 * (d / 30) ** 2, "ECX": 10e-6 * (d / 30) ** 3,
                "EYX": 0.5 * (d / 30) * (1 - d / 30), "EZX": -1.5 * (d / 30) * (1 - d / 30)}

    def gaps(self):
        """um; first-order equations for a target on the swept axis."""
        d = self.position()
        e = self.errors(d)

        def top(x, y):
            return e["EZX"] + 1000 * (y * e["EAX"] + (d - x) * e["EBX"])

        def side(x, z):
            return e["EYX"] + 1000 * (-z * e["EAX"] - (d - x) * e["ECX"])

        deltas = [top(ARM, 0), top(0, ARM), top(0, -ARM), side(0, SIDE_HEIGHT), side(ARM, SIDE_HEIGHT)]
        jitter = 0.01 * (self.ticks % 7 - 3)  # so that no register looks frozen
        return [100.0 - delta + jitter for delta in deltas]

    def words(self, unit, address, count):
        """The registers of a unit: 1 the head, 2 the controller. None: there are no such registers."""
        if unit == 1:
            if self.controller_read:  # a set is the head and then the controller: this is the next
                self.ticks, self.controller_read = self.ticks + 1, False
            if self.frozen_at is not None and self.time() > self.frozen_at:
                image = [30000] * 5
            else:
                image = [round(gap * COUNTS_PER_UM) for gap in self.gaps()]
        elif unit == 2:
            self.controller_read = True
            image = []
            for position in (self.position(), 15.0, 40.0):
                image += struct.unpack(">HH", struct.pack(">i", round(position * 100000)))
            image += [2012, 2034, 1, 1, 600]
        else:
            return None
        return image[address : address + count] if address + count <= len(image) else None


class RawServer:
    """Modbus TCP on plain sockets. `fault` is None or one of: silent, other_unit, exception, closed."""

    def __init__(self, machine, port=0):
        self.machine, self.fault, self.requests = machine, None, 0
        outer = self

        class Handler(socketserver.BaseRequestHandler):
            def handle(self):
                outer.connections.append(self.request)
                try:
                    while outer.serve_one(self.request):
                        pass
                except OSError:
                    pass

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address, daemon_threads = True, True

        self.connections = []
        self.make = lambda at: Server(("127.0.0.1", at), Handler)
        self.server = self.make(port)
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, args=(0.02,), daemon=True).start()

    @staticmethod
    def receive(connection, size):
        data = b""
        while len(data) < size:
            part = connection.recv(size - len(data))
            if not part:
                raise OSError("closed")
            data += part
        return data

    def serve_one(self, connection):
        transaction, _, length, unit = struct.unpack(">HHHB", self.receive(connection, 7))
        body = self.receive(connection, length - 1)
        function, address, value = struct.unpack(">BHH", body[:5].ljust(5, b"\0"))
        self.requests += 1
        if self.fault == "silent":
            return True
        if function == 6:
            self.machine.start()
            reply = body
        elif function not in (3, 4):
            reply = struct.pack(">BB", function | 0x80, 1)
        else:
            words = self.machine.words(unit, address, value)
            if self.fault == "exception" or words is None:
                reply = struct.pack(">BB", function | 0x80, 4 if words is not None else 2)
            else:
                reply = struct.pack(f">BB{value}H", function, 2 * value, *words)
        answered_by = unit + 7 if self.fault == "other_unit" else unit
        connection.sendall(struct.pack(">HHHB", transaction, 0, len(reply) + 1, answered_by) + reply)
        return True

    def vanish(self):
        self.server.shutdown()
        self.server.server_close()
        for connection in self.connections:
            try:
                connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        self.connections.clear()

    def come_back(self):
        self.server = self.make(self.port)
        threading.Thread(target=self.server.serve_forever, args=(0.02,), daemon=True).start()


def serve_with_pymodbus(machine, port):
    """Serves `machine` through pymodbus; returns when it listens."""
    from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
    from pymodbus.server import StartTcpServer

    logging.disable(logging.ERROR)

    class Registers(ModbusSparseDataBlock):
        def __init__(self, unit):
            self.unit = unit
            super().__init__({0: 0})

        def validate(self, address, count=1):
            return address == 100 or self.getValues(address, count) is not None

        def getValues(self, address, count=1):
            return [1] if address == 100 else machine.words(self.unit, address, count)

        def setValues(self, address, values, use_as_default=False):
            if address == 100:
                machine.start()

    units = {unit: ModbusSlaveContext(ir=Registers(unit), hr=Registers(unit), zero_mode=True)
             for unit in (1, 2)}
    context = ModbusServerContext(slaves=units, single=False)
    threading.Thread(target=StartTcpServer, daemon=True,
                     kwargs={"context": context, "address": ("127.0.0.1", port)}).start()
    for _ in range(100):
        try:
            socket.create_connection(("127.0.0.1", port), 0.2).close()
            return
        except OSError:
            time.sleep(0.05)
    raise RuntimeError("pymodbus does not listen")
