"""Connections to the plant's server, and the frames of a capture set."""
import array
import os
import struct

import crcmod.predefined
import grpc
from google.protobuf import json_format

from graspdb.v1 import capture_set_pb2, geometry_pb2

crc32c = crcmod.predefined.mkPredefinedCrcFun("crc-32c")


def channel(name=None, address="127.0.0.1:50051"):
    """A channel that trusts the plant's authority only. `name`.pem and `name`.key are the caller's identity."""
    def read(path):
        with open(path, "rb") as file:
            return file.read()

    key, certificate = (read(name + ".key"), read(name + ".pem")) if name else (None, None)
    return grpc.secure_channel(address, grpc.ssl_channel_credentials(read("plant.pem"), key, certificate))


def connect(name):
    """The same after the server has started and accepted the certificate."""
    out = channel(name)
    grpc.channel_ready_future(out).result(timeout=60)
    return out


def capture_set(folder):
    """The objects and frames of a folder."""
    with open(os.path.join(folder, "captures.json"), encoding="utf-8") as file:
        return json_format.Parse(file.read(), capture_set_pb2.CaptureSet())


def point_cloud(path):
    """The cloud of a PCD file as `graspdb simulate` writes it: x, y and z, DATA binary_compressed."""
    header = {}
    with open(path, "rb") as file:
        while "DATA" not in header:
            key, value = file.readline().split(maxsplit=1)
            header[key.decode()] = value
        packed_size, size = struct.unpack("<II", file.read(8))
        planes = array.array("f", decompress(file.read(packed_size)))
    points = array.array("f", bytes(size))
    for axis in range(3):
        points[axis::3] = planes[axis * len(planes) // 3:(axis + 1) * len(planes) // 3]
    return geometry_pb2.PointCloud(
        point_stride=12, width=int(header["WIDTH"]), data=points.tobytes(),
        fields=[geometry_pb2.PackedElementField(name=name, offset=4 * axis, type="NUMERIC_TYPE_FLOAT32")
                for axis, name in enumerate("xyz")])


def decompress(packed):
    """LZF, the compression of PCD files."""
    out, i = bytearray(), 0
    while i < len(packed):
        length, low = packed[i] >> 5, packed[i] & 31
        i += 1
        if length == 0:  # low + 1 bytes as they are
            out += packed[i:i + low + 1]
            i += low + 1
            continue
        if length == 7:
            length += packed[i]
            i += 1
        start = len(out) - (low << 8 | packed[i]) - 1  # a repetition, which may overlap itself
        i += 1
        for k in range(start, start + length + 2):
            out.append(out[k])
    return bytes(out)
