"""The answer to a scan."""
from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any, Optional, Tuple, Union

import numpy as np

from graspdb import geometry
from graspdb.geometry import FloatArray
from graspdb.v1 import catalog_pb2, geometry_pb2, recognition_pb2, recognition_service_pb2


class _Enum(enum.IntEnum):
    """Of the contract; a value that a newer server added is UNSPECIFIED."""

    @classmethod
    def _missing_(cls, value: object) -> Any:
        return cls(0)


class Status(_Enum):
    """Whether there is a result, and if not, why. docs/errors.md has what to do."""

    UNSPECIFIED = 0
    OK = 1
    EMPTY_REGION = 2
    NO_CLUSTER = 3
    UNKNOWN_OBJECT = 4
    AMBIGUOUS = 5
    ICP_REJECTED = 6
    NO_GRASP = 7
    OUT_OF_WORKSPACE = 8


class RejectionGate(_Enum):
    """The strongest evidence against the best hypothesis for an unknown object."""

    UNSPECIFIED = 0
    SCAN = 1
    MODEL = 2
    RESIDUAL = 3
    EXTENT = 4
    LITTLE_SEEN = 5
    MIN_SCORE = 6


class WorldFrameSource(_Enum):
    """Where the world frame of a result is from."""

    UNSPECIFIED = 0
    REQUEST = 1
    CELL = 2
    DOMINANT_PLANE = 3
    SENSOR = 4


@dataclass(frozen=True, eq=False)
class GraspProposal:
    """A taught grasp at the pose of the object."""

    grasp_id: str
    tcp_pose: FloatArray
    """T_world_tcp, 4 × 4; the tool's z axis points in the direction of approach."""
    approach_distance_m: float
    """From the start of the approach to the grasp, along the tool's z axis."""
    gripper_opening_m: float
    """Between the fingers before closing."""
    retreat_distance_m: float
    """Straight up in the world frame after closing."""
    priority: int

    @staticmethod
    def of(message: recognition_pb2.GraspProposal) -> "GraspProposal":
        # Servers of before the field send the deprecated ones only, of the same names.
        grasp: Union[catalog_pb2.Grasp, recognition_pb2.GraspProposal] = message
        if message.HasField("grasp"):
            grasp = message.grasp
        return GraspProposal(grasp.grasp_id, geometry.matrix_of_pose(message.tcp_pose), grasp.approach_distance_m,
                             grasp.gripper_opening_m, grasp.retreat_distance_m, grasp.priority)


@dataclass(frozen=True, eq=False)
class Detection:
    """One object on the table."""

    object: str
    """Resource name, such as `objects/box`; empty where unknown, as `stable_pose` and `view`."""
    stable_pose: str
    view: str
    score: float
    """Confidence, 0 to 1: a share s of the detections with score s is right."""
    status: Status
    """OK, or why the detection cannot be used."""
    pose: Optional[FloatArray]
    """T_world_object, 4 × 4; None where unknown."""
    equivalent_poses: FloatArray
    """Further poses that explain the scan as well, K × 4 × 4."""
    mesh_pose: Optional[FloatArray]
    """T_world_mesh of an object that was taught from CAD, 4 × 4."""
    grasps: Tuple[GraspProposal, ...]
    """The best one first."""
    centroid: FloatArray
    """Of the object's points in the world frame, 3 metres."""
    rejected_by: RejectionGate
    """The evidence against the best hypothesis, where the status is UNKNOWN_OBJECT."""
    touching: bool
    """Whether it touches another object, which a grasp may move."""
    message: recognition_pb2.Detection = field(repr=False)
    """All that the server has sent: candidates, alternatives, registration."""

    @staticmethod
    def of(message: recognition_pb2.Detection) -> "Detection":
        centroid = message.centroid
        return Detection(
            object=message.object, stable_pose=message.stable_pose, view=message.view, score=message.score,
            status=Status(message.status), pose=optional_matrix(message, "refined_pose"),
            equivalent_poses=geometry.read_only(
                np.reshape([geometry.matrix_of_pose(pose) for pose in message.equivalent_poses], (-1, 4, 4))),
            mesh_pose=optional_matrix(message, "mesh_pose"),
            grasps=tuple(GraspProposal.of(grasp) for grasp in message.grasps),
            centroid=geometry.read_only([centroid.x, centroid.y, centroid.z]),
            rejected_by=RejectionGate(message.rejected_by), touching=message.touching, message=message)


@dataclass(frozen=True, eq=False)
class Result:
    """The objects in one scan."""

    status: Status
    """OK if at least one detection is, else why there is none."""
    detections: Tuple[Detection, ...]
    """One for each object, also the unknown ones, the nearest to the sensor first."""
    sensor_pose: FloatArray
    """T_world_sensor that was used, 4 × 4."""
    world_frame_source: WorldFrameSource
    catalog_revision: int
    """Of the catalogue that was used."""
    catalog_id: str
    """Of the catalogue; a restore changes it. Empty with `omit_timings`."""
    message: recognition_service_pb2.RecognizeResponse = field(repr=False)
    """All that the server has sent: timings, stages."""
    scan: Union[geometry_pb2.PointCloud, geometry_pb2.DepthImage] = field(repr=False)
    """What was sent."""

    @staticmethod
    def of(message: recognition_service_pb2.RecognizeResponse,
           scan: Union[geometry_pb2.PointCloud, geometry_pb2.DepthImage]) -> "Result":
        return Result(
            status=Status(message.status), detections=tuple(Detection.of(each) for each in message.detections),
            sensor_pose=geometry.matrix_of_pose(message.sensor_pose),
            world_frame_source=WorldFrameSource(message.world_frame_source),
            catalog_revision=message.catalog_revision, catalog_id=message.catalog_id, message=message, scan=scan)

    @property
    def points(self) -> FloatArray:
        """The points of the scan in the sensor's frame, N × 3 or H × W × 3; NaN or zeros are no measurement."""
        if isinstance(self.scan, geometry_pb2.DepthImage):
            return geometry.points_of_depth(self.scan)
        return geometry.points_of_cloud(self.scan)

    def draw(self, axes: Any = None) -> Any:
        """Draws scan and detections as the sensor sees them, with matplotlib; returns the Axes.

        Each object has its name, its score and its frame (x red, y green, z blue); its best grasp is the line of the
        approach with the opening of the gripper. `axes` are those of a figure of yours.
        """
        from graspdb import _drawing  # matplotlib is an option

        return _drawing.draw(self, axes)


def optional_matrix(message: Any, name: str) -> Optional[FloatArray]:
    """A pose of a message; None where it is absent."""
    return geometry.matrix_of_pose(getattr(message, name)) if message.HasField(name) else None
