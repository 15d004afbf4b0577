"""idle_streams.py HOST:PORT CONNECTIONS STREAMS AGAIN [TOKEN_FILE]: streams that send nothing, until SIGTERM.

Opens the connections and shares the streams among them: RecognizeStream, UploadViews, WriteUploadViews, WatchCatalog and
server reflection in turn. A stream that the server refuses or ends is opened again after about AGAIN seconds, a connection too.
Prints what happened as one line of JSON. HTTP/2 is written by hand, so that the client takes little of the machine.
"""
import collections
import heapq
import json
import random
import resource
import selectors
import signal
import socket
import struct
import sys
import time

DATA, HEADERS, RST_STREAM, SETTINGS, PING, GOAWAY, WINDOW_UPDATE = 0, 1, 3, 4, 6, 7, 8
END_STREAM, ACK, END_HEADERS = 1, 1, 4
METHODS = ["/graspdb.v1.RecognitionService/RecognizeStream", "/graspdb.v1.CatalogService/UploadViews",
           "/graspdb.v1.UploadService/WriteUploadViews", "/graspdb.v1.ChangeService/WatchCatalog",
           "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo"]
WATCH = METHODS[3]
OWN_ADDRESS = ("127.0.0.2", 0)  # another caller than the robot, which has 127.0.0.1
HEARTBEAT_OF_AN_HOUR = b"\x19" + struct.pack("<d", 3600)  # WatchCatalogRequest.heartbeat_s


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def text(value):
    """A string of HPACK, not compressed."""
    value = value.encode()
    if len(value) < 127:
        return bytes([len(value)]) + value
    return bytes([127, (len(value) - 127) & 127 | 128, (len(value) - 127) >> 7]) + value


def headers(method, token):
    fields = [(":method", "POST"), (":scheme", "http"), (":path", method), (":authority", "flood"),
              ("content-type", "application/grpc"), ("te", "trailers")]
    if token:
        fields.append(("authorization", "Bearer " + token))
    return b"".join(b"\0" + text(name) + text(value) for name, value in fields)


class Connection:
    def __init__(self, flood, streams):
        self.flood = flood
        self.wanted = streams
        self.socket = None
        self.connect()

    def connect(self):
        self.unread = b""
        self.next_id = 1
        self.open = {}  # method by stream
        try:
            self.socket = socket.create_connection(self.flood.address, timeout=5, source_address=OWN_ADDRESS)
            self.socket.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS, 0, 0))
            self.socket.setblocking(False)
        except OSError:
            self.close()
            return
        self.flood.selector.register(self.socket, selectors.EVENT_READ, self)
        for k in range(self.wanted):
            self.start(METHODS[(k + self.flood.first_method) % len(METHODS)])
        self.flood.first_method += 1

    def send(self, data):
        try:
            self.socket.sendall(data)
        except OSError:
            self.close()

    def start(self, method):
        if self.socket is None:
            return
        stream, self.next_id = self.next_id, self.next_id + 2
        out = frame(HEADERS, END_HEADERS, stream, headers(method, self.flood.token))
        if method == WATCH:
            message = HEARTBEAT_OF_AN_HOUR
            out += frame(DATA, END_STREAM, stream, b"\0" + struct.pack(">I", len(message)) + message)
        self.open[stream] = method
        self.flood.counts["opened"] += 1
        self.send(out)

    def close(self):
        self.flood.counts["connections closed"] += 1
        if self.socket is not None:
            try:
                self.flood.selector.unregister(self.socket)
            except (KeyError, ValueError):
                pass
            self.socket.close()
        self.socket, self.open = None, {}
        self.flood.later(self.connect)

    def ended(self, stream):
        method = self.open.pop(stream, None)
        if method is not None:
            self.flood.counts["ended"] += 1
            self.flood.later(lambda: self.start(method))

    def read(self):
        try:
            data = self.socket.recv(1 << 16)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.close()
            return
        self.unread += data
        while self.socket is not None and len(self.unread) >= 9:
            size = int.from_bytes(self.unread[:3], "big")
            if len(self.unread) < 9 + size:
                return
            kind, flags = self.unread[3], self.unread[4]
            stream = int.from_bytes(self.unread[5:9], "big")
            payload, self.unread = self.unread[9:9 + size], self.unread[9 + size:]
            if kind == SETTINGS and not flags & ACK:
                self.send(frame(SETTINGS, ACK, 0))
            elif kind == PING and not flags & ACK:
                self.send(frame(PING, ACK, 0, payload))
            elif kind == DATA and size > 0:
                self.send(frame(WINDOW_UPDATE, 0, 0, struct.pack(">I", size)))
            if kind == RST_STREAM or (kind == HEADERS and flags & END_STREAM):
                self.ended(stream)


class Flood:
    def __init__(self, address, connections, streams, again, token):
        host, port = address.rsplit(":", 1)
        self.address = (host, int(port))
        self.again = again
        self.token = token
        self.selector = selectors.DefaultSelector()
        self.counts = collections.Counter()
        self.first_method = 0
        self.timers = []
        self.timer_count = 0
        self.is_stopped = False
        self.all = [Connection(self, streams // connections) for _ in range(connections)]

    def later(self, action):
        self.timer_count += 1
        heapq.heappush(self.timers, (time.monotonic() + self.again * random.uniform(0.5, 1.5), self.timer_count, action))

    def run(self):
        while not self.is_stopped:
            while self.timers and self.timers[0][0] <= time.monotonic():
                heapq.heappop(self.timers)[2]()
            for key, _ in self.selector.select(0.05):
                key.data.read()
        return {**self.counts, "open connections": sum(c.socket is not None for c in self.all),
                "open streams": sum(len(c.open) for c in self.all)}

    def stop(self, *_):
        self.is_stopped = True


def main():
    address, connections, streams, again = sys.argv[1:5]
    token = open(sys.argv[5], encoding="ascii").read().strip() if len(sys.argv) > 5 else ""
    begin = time.monotonic()
    flood = Flood(address, int(connections), int(streams), float(again), token)
    signal.signal(signal.SIGTERM, flood.stop)
    counts = flood.run()
    used = resource.getrusage(resource.RUSAGE_SELF)
    counts["client's cores"] = round((used.ru_utime + used.ru_stime) / (time.monotonic() - begin), 3)
    print(json.dumps(counts))


main()
