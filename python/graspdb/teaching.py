"""What is taught: grasps and views."""
from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from typing import Any, Optional, Tuple, Union

import numpy.typing as npt

from graspdb import geometry, point_files
from graspdb.geometry import Intrinsics
from graspdb.v1 import catalog_pb2, catalog_service_pb2, geometry_pb2

CloudLike = Union[npt.ArrayLike, point_files.PathLike, geometry_pb2.PointCloud]


@dataclass(frozen=True, eq=False)
class Grasp:
    """A tool pose that is taught for a stable pose."""

    grasp_id: str
    tcp_pose: npt.ArrayLike
    """T_object_tcp, 4 × 4; the tool's z axis points in the direction of approach."""
    approach_distance_m: float = 0.1
    """From the start of the approach to the grasp, along the tool's z axis."""
    gripper_opening_m: float = 0.0
    """Between the fingers before closing."""
    retreat_distance_m: float = 0.0
    """Straight up in the world frame after closing."""
    priority: int = 0
    """Grasps of higher priority are proposed first."""
    free_turn_deg: Optional[Tuple[float, float]] = None
    """Turns of the tool about the object's z axis that keep the grasp valid; None: valid only as taught."""

    def message(self) -> catalog_pb2.Grasp:
        turn = None
        if self.free_turn_deg is not None:
            turn = catalog_pb2.Grasp.FreeTurn(min_deg=self.free_turn_deg[0], max_deg=self.free_turn_deg[1])
        return catalog_pb2.Grasp(
            grasp_id=self.grasp_id, tcp_pose=geometry.pose_of_matrix(self.tcp_pose, "tcp_pose"),
            approach_distance_m=self.approach_distance_m, gripper_opening_m=self.gripper_opening_m,
            retreat_distance_m=self.retreat_distance_m, priority=self.priority, free_turn=turn)


@dataclass(frozen=True, eq=False)
class View:
    """One capture of an object in a stable pose: either a cloud or a depth image.

    A file is read when the view is sent.
    """

    stable_pose: str
    """`objects/{object}/stablePoses/{stable_pose}`."""
    cloud: Optional[CloudLike] = None
    """As of `Client.recognize`."""
    depth: Optional[npt.ArrayLike] = None
    intrinsics: Union[Intrinsics, npt.ArrayLike, None] = None
    depth_unit_m: float = 0.001
    object_pose: Optional[npt.ArrayLike] = None
    """T_world_object, 4 × 4. Give it: views without it do not share a frame, and no model is fused from them."""
    sensor_pose: Optional[npt.ArrayLike] = None
    """T_world_sensor, 4 × 4; None: that of the file, else from the dominant plane before the sensor."""
    region: Optional[npt.ArrayLike] = None
    """Where the object is searched for, in the world frame: smallest and largest corner, 2 × 3."""
    segmented: bool = False
    """True when only the object's points are in the capture."""
    view_id: str = ""
    """Empty: made from the content, so that the same capture has the same id."""

    def message(self) -> catalog_service_pb2.UploadViewsRequest:
        scan, sensor_pose = scan_message(self.cloud, self.depth, self.intrinsics, self.depth_unit_m, self.sensor_pose)
        view = catalog_pb2.View(segmented=self.segmented, sensor_pose=sensor_pose, **scan)
        if self.object_pose is not None:
            view.object_pose.CopyFrom(geometry.pose_of_matrix(self.object_pose, "object_pose"))
        return catalog_service_pb2.UploadViewsRequest(
            parent=self.stable_pose, view_id=self.view_id or _content_id(view), view=view,
            region_of_interest=geometry.box_message(self.region))


def _content_id(view: catalog_pb2.View) -> str:
    """The id that `graspdb import` gives the same capture."""
    content = view.cloud.data if view.HasField("cloud") else view.depth_image.SerializeToString(deterministic=True)
    return hashlib.sha256(content).hexdigest()[:20]


def scan_message(cloud: Optional[CloudLike], depth: Optional[npt.ArrayLike],
                 intrinsics: Union[Intrinsics, npt.ArrayLike, None], depth_unit_m: float,
                 sensor_pose: Optional[npt.ArrayLike]) -> "tuple[dict[str, Any], Optional[geometry_pb2.Pose]]":
    """The field of the scan, `cloud` or `depth_image`, and T_world_sensor."""
    if (cloud is None) == (depth is None):
        raise ValueError("give either a cloud or a depth image")
    pose = None if sensor_pose is None else geometry.pose_of_matrix(sensor_pose, "sensor_pose")
    if cloud is None:
        assert depth is not None
        return {"depth_image": geometry.depth_message(depth, intrinsics, depth_unit_m)}, pose
    if isinstance(cloud, geometry_pb2.PointCloud):
        return {"cloud": cloud}, pose
    if isinstance(cloud, (str, os.PathLike)):
        file = point_files.read_points(cloud)
        if pose is None and file.sensor_pose is not None:
            pose = geometry.pose_of_matrix(file.sensor_pose, "VIEWPOINT")
        return {"cloud": geometry.cloud_message(file.points)}, pose
    return {"cloud": geometry.cloud_message(cloud)}, pose
