"""Client of graspdb: recognition of objects, their poses and taught grasps in depth images.

    import graspdb

    with graspdb.Client("127.0.0.1:50051") as client:
        result = client.recognize("scan.pcd")
        for detection in result.detections:
            print(detection.object, detection.score, detection.pose, detection.grasps)

Metres and 4 × 4 poses: `T_a_b` is the pose of frame b in frame a, p_a = T_a_b @ p_b. The sensor's frame has x to the
right, y down and z forward; the world's has z up and the table at z = 0. `graspdb.v1` has the published messages.
"""
from graspdb import errors
from graspdb._upload import UploadResult
from graspdb.changes import Change, ChangedResource, ChangeKind, Outcome
from graspdb.client import Client
from graspdb.errors import Error, Reason
from graspdb.geometry import Intrinsics
from graspdb.point_files import PointFile, read_points
from graspdb.pushing import Pusher
from graspdb.results import Detection, GraspProposal, RejectionGate, Result, Status, WorldFrameSource
from graspdb.teaching import Grasp, View

__all__ = [
    "Change", "ChangeKind", "ChangedResource", "Client", "Detection", "Error", "Grasp", "GraspProposal", "Intrinsics",
    "Outcome", "PointFile", "Pusher", "Reason", "RejectionGate", "Result", "Status", "UploadResult", "View",
    "WorldFrameSource", "errors", "read_points",
]
