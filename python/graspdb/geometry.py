"""Poses, cameras and scans between numpy and the published messages.

Metres. `T_a_b` is the pose of frame b in frame a, a 4 × 4 array with p_a = T_a_b @ p_b. The sensor's frame has x to the
right, y down and z forward; the world's has z up and the table at z = 0.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from graspdb.v1 import geometry_pb2

FloatArray = npt.NDArray[np.float64]

# How far R^T R may be from the identity: more than rounding to three digits, less than a scale of 1.01.
_ROTATION_TOLERANCE = 2e-3
_NO_MEASUREMENT = 65535  # a count, as 0


@dataclass(frozen=True)
class Intrinsics:
    """The pinhole model of a depth camera without distortion, in pixels."""

    fx: float
    fy: float
    cx: float
    cy: float

    @staticmethod
    def from_matrix(matrix: npt.ArrayLike) -> "Intrinsics":
        """Of the 3 × 3 camera matrix of OpenCV and of ROS' CameraInfo.k."""
        k = np.asarray(matrix, np.float64).reshape(3, 3)
        return Intrinsics(k[0, 0], k[1, 1], k[0, 2], k[1, 2])


def read_only(array: npt.ArrayLike) -> FloatArray:
    """A float64 array that cannot be written."""
    out = np.array(array, np.float64)
    out.flags.writeable = False
    return out


def matrix_of_pose(pose: geometry_pb2.Pose) -> FloatArray:
    """The pose as a read-only 4 × 4 array."""
    p, q = pose.position, pose.orientation
    x, y, z, w = np.array([q.x, q.y, q.z, q.w]) / np.linalg.norm([q.x, q.y, q.z, q.w])
    return read_only([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
        [0, 0, 0, 1],
    ])


def pose_of_matrix(matrix: npt.ArrayLike, name: str) -> geometry_pb2.Pose:
    """The message of a 4 × 4 array; ValueError, with `name`, if it is no rigid transform."""
    m = np.asarray(matrix, np.float64)
    if m.shape != (4, 4) or not np.isfinite(m).all() or not np.array_equal(m[3], [0, 0, 0, 1]):
        raise ValueError(f"{name} is no pose; give a 4 × 4 array of finite numbers whose last row is 0, 0, 0, 1")
    r = m[:3, :3]
    if np.abs(r.T @ r - np.eye(3)).max() > _ROTATION_TOLERANCE or np.linalg.det(r) < 0:
        raise ValueError(f"{name} is no rigid transform; its upper left 3 × 3 part must be a rotation, without scale")
    x, y, z, w = _quaternion(r)
    return geometry_pb2.Pose(position=geometry_pb2.Vector3(x=m[0, 3], y=m[1, 3], z=m[2, 3]),
                             orientation=geometry_pb2.Quaternion(x=x, y=y, z=z, w=w))


def _quaternion(r: FloatArray) -> FloatArray:
    """x, y, z, w of the rotation that is nearest to `r` (Bar-Itzhack 2000, version 3)."""
    (a, b, c), (d, e, f), (g, h, i) = r
    k = np.array([[a - e - i, 0, 0, 0], [d + b, e - a - i, 0, 0], [g + c, h + f, i - a - e, 0],
                  [h - f, c - g, d - b, a + e + i]])
    q: FloatArray = np.linalg.eigh(k)[1][:, -1]  # reads the lower triangle; ascending
    return q if q[3] >= 0 else -q


def box_message(region: Optional[npt.ArrayLike]) -> Optional[geometry_pb2.AxisAlignedBox]:
    """The message of the two corners of a box, the smallest one first."""
    if region is None:
        return None
    corners = np.asarray(region, np.float64)
    if corners.shape != (2, 3):
        raise ValueError("region has the wrong shape; give its smallest and its largest corner, as a 2 × 3 array")
    low, high = (geometry_pb2.Vector3(x=x, y=y, z=z) for x, y, z in corners)
    return geometry_pb2.AxisAlignedBox(min=low, max=high)


def cloud_message(points: npt.ArrayLike) -> geometry_pb2.PointCloud:
    """The message of N × 3 points, or of H × W × 3 points of an organised cloud."""
    array = np.asarray(points)
    if array.ndim not in (2, 3) or array.shape[-1] != 3 or array.dtype.kind not in "fiu":
        raise ValueError(f"a cloud of shape {array.shape} and type {array.dtype} cannot be sent; give an N × 3 or "
                         "H × W × 3 array of x, y and z in metres, in the sensor's frame")
    numeric = geometry_pb2.PackedElementField.NUMERIC_TYPE_FLOAT32
    return geometry_pb2.PointCloud(
        point_stride=12, width=array.shape[1] if array.ndim == 3 else 0, data=array.astype("<f4").tobytes(),
        fields=[geometry_pb2.PackedElementField(name=name, offset=4 * k, type=numeric)
                for k, name in enumerate("xyz")])


def depth_message(depth: npt.ArrayLike, intrinsics: Union[Intrinsics, npt.ArrayLike, None],
                  depth_unit_m: float) -> geometry_pb2.DepthImage:
    """The message of an H × W image: of 16-bit counts, or of floats in metres."""
    image = np.asarray(depth)
    if image.ndim != 2 or image.dtype.kind not in "fu" or (image.dtype.kind == "u" and image.dtype.itemsize > 2):
        raise ValueError(f"a depth image of shape {image.shape} and type {image.dtype} cannot be sent; give an H × W "
                         "array of 16-bit counts (uint16), or of floats in metres")
    if intrinsics is None:
        raise ValueError("a depth image needs the camera's intrinsics; give Intrinsics(fx, fy, cx, cy), or the "
                         "3 × 3 camera matrix")
    camera = intrinsics if isinstance(intrinsics, Intrinsics) else Intrinsics.from_matrix(intrinsics)
    if image.dtype.kind == "f":
        image, depth_unit_m = _counts(image)
    return geometry_pb2.DepthImage(
        depth_unit_m=depth_unit_m, data=image.astype("<u2").tobytes(),
        intrinsics=geometry_pb2.CameraIntrinsics(width=image.shape[1], height=image.shape[0], fx=camera.fx,
                                                 fy=camera.fy, cx=camera.cx, cy=camera.cy))


def _counts(depth: npt.NDArray[Any]) -> "tuple[npt.NDArray[Any], float]":
    """Metres as counts of the smallest unit that has room for all of them: 0.05 mm up to 3 m."""
    measured = np.isfinite(depth) & (depth > 0)
    unit = float(depth.max(initial=0.0, where=measured)) / (_NO_MEASUREMENT - 1) or 0.001
    return np.where(measured, np.rint(np.where(measured, depth, 0) / unit), 0), unit


def points_of_cloud(cloud: geometry_pb2.PointCloud) -> FloatArray:
    """The points of a cloud with float fields, N × 3, or H × W × 3 of an organised one."""
    code = {geometry_pb2.PackedElementField.NUMERIC_TYPE_FLOAT32: "<f4",
            geometry_pb2.PackedElementField.NUMERIC_TYPE_FLOAT64: "<f8"}
    fields = {field.name: field for field in cloud.fields}
    records = np.frombuffer(cloud.data, np.dtype({
        "names": list("xyz"), "formats": [code[fields[name].type] for name in "xyz"],
        "offsets": [fields[name].offset for name in "xyz"], "itemsize": cloud.point_stride}))
    points = np.stack([records[name] for name in "xyz"], axis=-1).astype(np.float64)
    points = points.reshape(-1, cloud.width, 3) if cloud.width else points
    return points


def points_of_depth(image: geometry_pb2.DepthImage) -> FloatArray:
    """The H × W × 3 points of a depth image in the sensor's frame, NaN where there is no measurement."""
    camera = image.intrinsics
    counts = np.frombuffer(image.data, "<u2").reshape(camera.height, camera.width)
    z = np.where((counts == 0) | (counts == _NO_MEASUREMENT), np.nan, counts * (image.depth_unit_m or 0.001))
    v, u = np.indices(z.shape)
    points: FloatArray = np.stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z], axis=-1)
    return points


def name_list(names: Sequence[str], parameter: str) -> "list[str]":
    """A list of names; a single string is no list of its letters."""
    if isinstance(names, str):
        raise ValueError(f"{parameter} is one string; give a list of them")
    return list(names)
