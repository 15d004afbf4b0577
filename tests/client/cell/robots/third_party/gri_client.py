"""An independent client of the Generic Robot Interface, version 1.

Written from the interface's documentation alone, with Python's own modules: it shares no source
with the server, so that a misreading on one side is detected on the other.
"""

import math
import socket
import struct
from collections import namedtuple

MAGIC = b"GRI\0"
VERSION = 1
REQUEST = struct.Struct("<4sBBBBH3i4i4i")
RESPONSE = struct.Struct("<4sBBBBHh3i4i10i")
MILLIONTHS = 10**6

(STATUS, TRIGGER_JOB_SYNC, TRIGGER_JOB_ASYNC, GET_JOB_STATUS, GET_NEXT_POSE, GET_RELATED_POSE,
 HEC_INIT, HEC_SET_POSE, HEC_CALIBRATE) = range(1, 10)
INACTIVE, RUNNING, DONE, FAILED = range(1, 5)

CODES = {
    0: "NO_ERROR", -1: "UNKNOWN_ERROR", -2: "INTERNAL_ERROR", -3: "API_NOT_REACHABLE",
    -4: "API_RESPONSE_ERROR", -5: "PIPELINE_NOT_AVAILABLE", -6: "INVALID_REQUEST_ERROR",
    -7: "INVALID_REQUEST_LENGTH", -8: "INVALID_ACTION", -9: "PROCESSING_TIMEOUT",
    -10: "UNKNOWN_PROTOCOL_VERSION", -11: "WRONG_PROTOCOL_FOR_JOB", -12: "JOB_DOES_NOT_EXIST",
    -13: "MISCONFIGURED_JOB", -14: "HEC_CONFIG_ERROR", -15: "HEC_INIT_ERROR",
    -16: "HEC_SET_POSE_ERROR", -17: "HEC_CALIBRATE_ERROR", -18: "HEC_INSUFFICIENT_DETECTION",
    1: "NO_POSES_FOUND", 2: "NO_RELATED_POSES", 3: "NO_RETURN_SPECIFIED", 4: "JOB_STILL_RUNNING",
}

# Position in millimetres, up to four numbers of the rotation in the unit of the pose format.
Pose = namedtuple("Pose", "position rotation")
Response = namedtuple("Response", "pose_format action job_id code pose data")


class Closed(Exception):
    """The server closed the connection."""


def request_bytes(action, job=0, pose=None, pose_format=2, data=(0, 0, 0, 0), version=VERSION,
                  length=REQUEST.size, magic=MAGIC):
    position, rotation = pose or ((0, 0, 0), (0, 0, 0, 1) if pose_format == 2 else (0, 0, 0, 0))
    rotation = tuple(rotation) + (0,) * (4 - len(rotation))
    numbers = [round(number * MILLIONTHS) for number in (*position, *rotation)]
    return REQUEST.pack(magic, version, length, pose_format, action, job, *numbers, *data)


def response_of(raw):
    fields = RESPONSE.unpack(raw)
    magic, version, length, pose_format, action, job, code = fields[:7]
    if (magic, version, length) != (MAGIC, VERSION, RESPONSE.size):
        raise ValueError(f"not a response: {raw[:8]!r}")
    millionths = [number / MILLIONTHS for number in fields[7:14]]
    # data_1 of the documentation is data[1] here.
    return Response(pose_format, action, job, CODES[code],
                    Pose(tuple(millionths[:3]), tuple(millionths[3:])), (None, *fields[14:]))


class GriClient:
    """One connection. `address` is the robot's own, if it has several."""

    def __init__(self, port, address="127.0.0.1", timeout_s=20):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout_s, (address, 0))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, raw):
        self.socket.sendall(raw)

    def receive(self):
        raw = b""
        while len(raw) < RESPONSE.size:
            try:
                part = self.socket.recv(RESPONSE.size - len(raw))
            except ConnectionResetError:
                part = b""
            if not part:
                raise Closed
            raw += part
        return response_of(raw)

    def call(self, action, job=0, **more):
        self.send(request_bytes(action, job, **more))
        return self.receive()


# Rotations are matrices of rows.
def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turn(axis, angle):
    """About X, Y or Z, in radians."""
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    out = [[float(row == column) for column in range(3)] for row in range(3)]
    out[i][i] = out[j][j] = math.cos(angle)
    out[i][j], out[j][i] = -math.sin(angle), math.sin(angle)
    return out


def of_quaternion(w, x, y, z):
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


SEQUENCES = "XYZ XZY YXZ YZX ZXY ZYX XYX XZX YXY YZY ZXZ ZYZ".split()


def rotation_of(numbers, pose_format):
    """The rotation of the numbers in one of the 51 formats."""
    if pose_format == 1:
        return of_quaternion(*numbers)
    if pose_format == 2:
        return of_quaternion(numbers[3], *numbers[:3])
    if pose_format == 3:
        angle = math.hypot(*numbers[:3])
        half = math.sin(angle / 2) / angle if angle else 0.5
        return of_quaternion(math.cos(angle / 2), *(half * number for number in numbers[:3]))
    place, rest = divmod(pose_format - 4, 4)
    backward, radians = divmod(rest, 2)
    angles = [number if radians else math.radians(number) for number in numbers[:3]]
    if backward:
        angles.reverse()
    first, second, third = (turn(axis, angle) for axis, angle in zip(SEQUENCES[place], angles))
    return product(product(first, second), third)
