"""Points from PCD and PLY files, by numpy alone.

Files are untrusted: no size of a header is used before it was compared with that of the file.
"""
from __future__ import annotations

import os
import struct
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from graspdb import geometry
from graspdb.v1 import geometry_pb2

PathLike = Union[str, "os.PathLike[str]"]

_LONGEST_HEADER = 16 << 10
_LONGEST_PADDING = 64 << 10
_PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
              "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
              "double": "f8", "float64": "f8"}


@dataclass(frozen=True, eq=False)
class PointFile:
    """The points of a file."""

    points: npt.NDArray[np.float32]
    """N × 3, or H × W × 3 of an organised cloud; metres, in the sensor's frame."""
    sensor_pose: Optional[geometry.FloatArray]
    """T_world_sensor of a PCD file's VIEWPOINT, 4 × 4; None where that is missing or the identity."""


def read_points(path: PathLike) -> PointFile:
    """Reads a .pcd or .ply file; ValueError, with the path and advice, if that is not possible."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        if data.startswith(b"ply"):
            return PointFile(_read_ply(data), None)
        if os.fspath(path).lower().endswith(".pcd"):
            return _read_pcd(data)
        raise ValueError("is neither PCD nor PLY; convert it to one of these, or give its points as an array")
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)} {error}") from None


def _read_pcd(data: bytes) -> PointFile:
    header, start = _pcd_header(data)
    try:
        names, sizes, types = (header[key] for key in ("FIELDS", "SIZE", "TYPE"))
        counts = [int(count) for count in header.get("COUNT", ["1"] * len(names))]
        width, height = int(header["WIDTH"][0]), int(header["HEIGHT"][0])
        widths = [int(size) * count for size, count in zip(sizes, counts)]
        encoding = header["DATA"][0]
    except (KeyError, IndexError, ValueError):
        raise ValueError("has no complete PCD header; export it again") from None
    if not len(names) == len(sizes) == len(types) == len(counts) or min(counts + widths + [width, height]) < 1:
        raise ValueError("has a PCD header whose lines do not fit each other; export it again")
    columns = [names.index(name) if names.count(name) == 1 else -1 for name in "xyz"]
    if any(k < 0 or types[k] != "F" or sizes[k] not in ("4", "8") or counts[k] != 1 for k in columns):
        raise ValueError("has no x, y and z as floats; export the points as x, y and z of TYPE F")
    formats, offsets = ["<f" + sizes[k] for k in columns], [sum(widths[:k]) for k in columns]
    count, stride, body = width * height, sum(widths), memoryview(data)[start:]
    if encoding == "ascii":
        points = _table(bytes(body), count, sum(counts), [sum(counts[:k]) for k in columns])
    elif encoding == "binary":
        points = _records(body, count, stride, formats, offsets)
        _check_end(body[count * stride:])
    elif encoding == "binary_compressed":
        points = _planes(body, count, stride, formats, offsets)
    else:
        raise ValueError(f"has DATA {encoding[:40]}; save it as binary")
    pose = _viewpoint(header.get("VIEWPOINT", []))
    return PointFile(points.reshape(height, width, 3) if height > 1 else points, pose)


def _pcd_header(data: bytes) -> Tuple[Dict[str, List[str]], int]:
    """The words of each line by their first, up to DATA, and where the body begins."""
    header: Dict[str, List[str]] = {}
    start = 0
    while "DATA" not in header:
        end = data.find(b"\n", start, _LONGEST_HEADER)
        if end < 0:
            raise ValueError("has no complete PCD header; export it again")
        words = data[start:end].decode("ascii", "replace").split()
        start = end + 1
        if words and not words[0].startswith("#"):
            header[words[0]] = words[1:]
    return header, start


def _viewpoint(words: List[str]) -> Optional[geometry.FloatArray]:
    if not words:
        return None
    try:
        x, y, z, qw, qx, qy, qz = (float(word) for word in words)
    except ValueError:
        raise ValueError("has a VIEWPOINT that is not seven numbers; export it again") from None
    norm = float(np.linalg.norm([qw, qx, qy, qz]))
    if not np.isfinite([x, y, z, norm]).all() or abs(norm - 1) > 1e-3:
        raise ValueError("has a VIEWPOINT without a unit quaternion; correct it, or delete the line")
    if (x, y, z, qx, qy, qz) == (0, 0, 0, 0, 0, 0):
        return None
    return geometry.matrix_of_pose(geometry_pb2.Pose(position=geometry_pb2.Vector3(x=x, y=y, z=z),
                                                     orientation=geometry_pb2.Quaternion(x=qx, y=qy, z=qz, w=qw)))


def _read_ply(data: bytes) -> npt.NDArray[np.float32]:
    end = data.find(b"end_header", 0, _LONGEST_HEADER)
    start = data.find(b"\n", end) + 1
    lines = [line.split() for line in data[:max(end, 0)].decode("ascii", "replace").splitlines()]
    lines = [line for line in lines if line and line[0] not in ("comment", "obj_info")]
    elements = [k for k, line in enumerate(lines) if line[0] == "element"]
    if end < 0 or start == 0 or not elements or len(lines) < 2 or lines[1][0] != "format" or len(lines[1]) < 2:
        raise ValueError("has no complete PLY header; export it again")
    first = lines[elements[0]]
    properties = lines[elements[0] + 1:(elements + [len(lines)])[1]]
    if len(first) != 3 or first[1] != "vertex" or not first[2].isdecimal():
        raise ValueError("does not begin with its vertices; save it with the element vertex first")
    if any(len(line) != 3 or line[1] not in _PLY_TYPES for line in properties):
        raise ValueError("has vertices with lists or unknown properties; save it with x, y and z alone")
    names = [line[2] for line in properties]
    if any(names.count(name) != 1 for name in "xyz"):
        raise ValueError("has no vertices with x, y and z; save it with these")
    count, columns, body = int(first[2]), [names.index(name) for name in "xyz"], memoryview(data)[start:]
    if lines[1][1] == "ascii":
        return _table(bytes(body), count, len(names), columns)
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(lines[1][1])
    if order is None:
        raise ValueError("has an unknown PLY format; save it as binary_little_endian")
    types = [np.dtype(order + _PLY_TYPES[line[1]]) for line in properties]
    offsets = np.cumsum([0] + [each.itemsize for each in types]).tolist()
    points = _records(body, count, offsets[-1], [types[k].str for k in columns], [offsets[k] for k in columns])
    if all(lines[k][-1] == "0" for k in elements[1:]):
        _check_end(body[count * offsets[-1]:])
    return points


def _table(body: bytes, count: int, width: int, columns: List[int]) -> npt.NDArray[np.float32]:
    """Columns of rows of numbers in text."""
    rows = [row for row in map(bytes.split, body.splitlines()) if row]
    if count < 1 or len(rows) < count:
        raise ValueError(f"ends before its {count} points; copy or export it again")
    if any(len(row) != width for row in rows[:count]):
        raise ValueError(f"has rows with more or fewer numbers than the {width} of its header; export it again")
    try:
        return np.array([[row[k] for k in columns] for row in rows[:count]], "S64").astype(np.float32)
    except ValueError:
        raise ValueError("has words in place of numbers; export it again") from None


def _check_end(rest: Any) -> None:
    """Of what is behind the points: fewer zeros than a page of memory, which versions of PCL write, or nothing."""
    if len(rest) >= _LONGEST_PADDING or any(rest):
        raise ValueError("has bytes behind its points, as a copy in text mode has, which writes 0D 0A for each 0A; copy or "
                         "capture it again")


def _records(body: Any, count: int, stride: int, formats: List[str], offsets: List[int]) -> npt.NDArray[np.float32]:
    """Points one after the other."""
    if count < 1 or len(body) < count * stride:
        raise ValueError(f"ends before its {count} points; copy or export it again")
    records = np.frombuffer(body, np.dtype({"names": list("xyz"), "formats": formats, "offsets": offsets,
                                            "itemsize": stride}), count)
    return np.stack([records[name].astype(np.float32) for name in "xyz"], axis=-1)


def _planes(body: Any, count: int, stride: int, formats: List[str], offsets: List[int]) -> npt.NDArray[np.float32]:
    """A compressed PCD: all x, then all y, and so on."""
    packed_size, size = struct.unpack_from("<II", body) if len(body) >= 8 else (0, 0)
    if size != count * stride or len(body) - 8 < packed_size:
        raise ValueError(f"ends before its {count} points; copy or export it again")
    _check_end(body[8 + packed_size:])
    plain = _decompress(bytes(body[8:8 + packed_size]), size)
    planes = [np.frombuffer(plain, formats[k], count, count * offsets[k]) for k in range(3)]
    return np.stack([plane.astype(np.float32) for plane in planes], axis=-1)


def _decompress(packed: bytes, size: int) -> bytes:
    """LZF, the compression of PCD files; grows with what the file has, up to `size` bytes."""
    out = bytearray()
    i = 0
    try:
        while i < len(packed) and len(out) <= size:
            length, low = packed[i] >> 5, packed[i] & 31
            i += 1
            if length == 0:  # low + 1 bytes as they are
                out += packed[i:i + low + 1]
                i += low + 1
                continue
            if length == 7:
                length += packed[i]
                i += 1
            start = len(out) - (low << 8 | packed[i]) - 1
            i += 1
            if start < 0:
                raise IndexError
            length += 2
            piece = bytes(out[start:start + length])
            while len(piece) < length:  # a repetition that overlaps itself
                piece += piece
            out += piece[:length]
    except IndexError:
        out.clear()
    if len(out) != size:
        raise ValueError("has damaged compressed points; copy or export it again")
    return bytes(out)
