"""A Modbus TCP server that shares no code with abbe: pymodbus and struct.

Unit 1 holds in its input registers one number of every type in every order, packed by struct. Unit 2
holds 321 in holding register 5. The port stands on the first line of the output.
"""
import socket
import struct

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartTcpServer

NUMBERS = [("h", -12345), ("H", 54321), ("i", -1234567890), ("I", 3456789012), ("f", -1234.5678)]
ORDERS = ["ABCD", "CDAB", "BADC", "DCBA"]


def words(code, number, order):
    packed = struct.pack(">" + code, number)
    if len(packed) == 2:
        packed = packed if order in ("ABCD", "CDAB") else packed[::-1]
    else:
        packed = bytes(packed["ABCD".index(letter)] for letter in order)
    return list(struct.unpack(f">{len(packed) // 2}H", packed))


registers = []
for code, number in NUMBERS:
    for order in ORDERS:
        registers += words(code, number, order)

units = {
    1: ModbusSlaveContext(ir=ModbusSequentialDataBlock(0, registers), zero_mode=True),
    2: ModbusSlaveContext(hr=ModbusSequentialDataBlock(0, [0, 0, 0, 0, 0, 321]), zero_mode=True),
}
with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
print(port, flush=True)
StartTcpServer(context=ModbusServerContext(slaves=units, single=False), address=("127.0.0.1", port))
