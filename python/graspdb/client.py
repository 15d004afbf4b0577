"""The client of a graspdb server."""
from __future__ import annotations

import uuid
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

import numpy.typing as npt

from graspdb import _channel, _upload, errors, geometry
from graspdb._progress import OnProgress, reporter
from graspdb.changes import Change, Outcome, changes_of
from graspdb.geometry import Intrinsics
from graspdb.point_files import PathLike
from graspdb.results import Result
from graspdb.teaching import CloudLike, Grasp, View, scan_message
from graspdb.v1 import (backup_pb2, backup_service_pb2, backup_service_pb2_grpc, catalog_pb2, catalog_service_pb2,
                        catalog_service_pb2_grpc, cell_pb2, cell_service_pb2_grpc, change_service_pb2,
                        change_service_pb2_grpc, object_history_service_pb2_grpc, recognition_service_pb2,
                        recognition_service_pb2_grpc, upload_service_pb2_grpc)


class Client:
    """A connection to a server. Connects with the first call; thread-safe; to be used in `with`, or closed.

    Calls raise an `errors.Error`, with the server's advice; arguments that cannot be sent raise ValueError. Unary calls
    are sent again where that has no further effect after the connection is lost, and all of them while the server is
    busy.

    `catalog`, `cells`, `uploads`, `backups`, `changes`, `history` and `recognition` are the stubs of all services, for
    what has no method here. They have the same token, time limits, retries and errors.

    Args:
      server: HOST:PORT.
      ca: PEM file of the authorities that sign the server's certificate. Any of `ca`, `cert` and `key` enables TLS,
        without `ca` with the authorities that gRPC has. The files are read here, once.
      cert: PEM file of this client's certificate.
      key: PEM file of its key.
      token: token of the caller's identity; not sent to another machine without TLS.
      token_file: file with the token in its first line, read with each call.
      timeout_s: time limit of unary calls without one of their own, with their retries.
      retry: whether calls are sent again.
      busy_retries: how often a call is sent again while the server is busy; seven take about 3 s.
    """

    def __init__(self, server: str = "127.0.0.1:50051", *, ca: Optional[PathLike] = None,
                 cert: Optional[PathLike] = None, key: Optional[PathLike] = None, token: Optional[str] = None,
                 token_file: Optional[PathLike] = None, timeout_s: float = 30.0, retry: bool = True,
                 busy_retries: int = 7) -> None:
        settings = _channel.Settings(server, ca, cert, key, token, token_file, timeout_s, retry, busy_retries)
        self._busy_retries = busy_retries if retry else 0
        self._connection, channel = _channel.connect(settings)
        self.backups = backup_service_pb2_grpc.BackupServiceStub(channel)
        self.catalog = catalog_service_pb2_grpc.CatalogServiceStub(channel)
        self.cells = cell_service_pb2_grpc.CellServiceStub(channel)
        self.changes = change_service_pb2_grpc.ChangeServiceStub(channel)
        self.history = object_history_service_pb2_grpc.ObjectHistoryServiceStub(channel)
        self.recognition = recognition_service_pb2_grpc.RecognitionServiceStub(channel)
        self.uploads = upload_service_pb2_grpc.UploadServiceStub(channel)

    def close(self) -> None:
        """Ends the connection, and the calls in progress."""
        self._connection.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def status(self) -> catalog_service_pb2.CatalogStatus:
        """Version, settings and usage of the server."""
        return self.catalog.GetCatalogStatus(catalog_service_pb2.GetCatalogStatusRequest())

    def recognize(self, cloud: Optional[CloudLike] = None, *, depth: Optional[npt.ArrayLike] = None,
                  intrinsics: Union[Intrinsics, npt.ArrayLike, None] = None, depth_unit_m: float = 0.001,
                  cell: str = "", sensor_pose: Optional[npt.ArrayLike] = None, region: Optional[npt.ArrayLike] = None,
                  segmented: bool = False, pipeline: Optional[cell_pb2.PipelineParameters] = None,
                  omit_timings: bool = False, timeout_s: Optional[float] = None) -> Result:
        """Recognises the objects in one scan: a cloud, or a depth image.

        A scan without a known object is no error: the result's status has the reason.

        Args:
          cloud: N × 3 or H × W × 3 (organised) points in metres, in the sensor's frame, with NaN or zeros where there is
            no measurement; or the path of a PCD or PLY file; or a PointCloud message.
          depth: H × W image of distances along the sensor's z axis: 16-bit counts, with 0 and 65535 where there is no
            measurement, or floats in metres, with NaN or 0 there.
          intrinsics: of the depth camera; also a 3 × 3 camera matrix.
          depth_unit_m: metres of a count.
          cell: `cells/{cell}`, whose calibration, region and settings apply.
          sensor_pose: T_world_sensor, 4 × 4. None: that of the file, of the cell, or from the dominant plane before the
            sensor.
          region: where objects are searched for, in the world frame: smallest and largest corner, 2 × 3 metres. None:
            that of the cell.
          segmented: True when the scan has only one object's points.
          pipeline: settings for this scan.
          omit_timings: for results that are the same, byte by byte, for the same scan and revision.
          timeout_s: of this call.
        """
        scan, pose = scan_message(cloud, depth, intrinsics, depth_unit_m, sensor_pose)
        request = recognition_service_pb2.RecognizeRequest(
            cell=cell, sensor_pose=pose, region_of_interest=geometry.box_message(region), segmented=segmented,
            pipeline=pipeline, omit_timings=omit_timings, **scan)
        response = self.recognition.Recognize(request, timeout=timeout_s)
        return Result.of(response, next(iter(scan.values())))

    def create_object(self, object_id: str, *, display_name: str = "", labels: Sequence[str] = (), draft: bool = False,
                      exist_ok: bool = False) -> str:
        """Creates an object without stable poses; returns its name, `objects/{object_id}`.

        With `exist_ok` an object that exists stays as it is. A draft is recognised only by cells with
        `include_drafts`.
        """
        request = catalog_service_pb2.CreateObjectRequest(object_id=object_id, object=catalog_pb2.Object(
            display_name=display_name, labels=geometry.name_list(labels, "labels"), release=_release(draft)))
        _create(self.catalog.CreateObject, request, exist_ok)
        return f"objects/{object_id}"

    def create_stable_pose(self, object: str, stable_pose_id: str, *, display_name: str = "", symmetry_order: int = 1,
                           grasps: Sequence[Union[Grasp, catalog_pb2.Grasp]] = (), min_score: Optional[float] = None,
                           mesh_pose: Optional[npt.ArrayLike] = None, draft: bool = False,
                           exist_ok: bool = False) -> str:
        """Creates a stable pose without views; returns its name, `{object}/stablePoses/{stable_pose_id}`.

        Args:
          object: `objects/{object}`.
          stable_pose_id: id within the object.
          display_name: for people.
          symmetry_order: about the object's z axis: 1 none, n for n-fold, 0 for any turn.
          grasps: taught grasps, T_object_tcp.
          min_score: detections that score lower are UNKNOWN_OBJECT.
          mesh_pose: T_object_mesh, 4 × 4, of an object with a mesh.
          draft: whether only cells with `include_drafts` recognise it.
          exist_ok: whether one that exists stays as it is, also if it differs.
        """
        stable_pose = catalog_pb2.StablePose(
            display_name=display_name, symmetry_order=symmetry_order, min_score=min_score, release=_release(draft),
            grasps=[each.message() if isinstance(each, Grasp) else each for each in grasps],
            mesh_pose=None if mesh_pose is None else geometry.pose_of_matrix(mesh_pose, "mesh_pose"))
        request = catalog_service_pb2.CreateStablePoseRequest(parent=object, stable_pose_id=stable_pose_id,
                                                              stable_pose=stable_pose)
        _create(self.catalog.CreateStablePose, request, exist_ok)
        return f"{object}/stablePoses/{stable_pose_id}"

    def teach(self, views: Iterable[View]) -> catalog_service_pb2.UploadViewsResponse:
        """Teaches views one after the other; the next recognition uses each of them.

        A view that exists is counted and left as it is. The first view that cannot be taught raises its error; the
        views before it stay.
        """
        requests = [view.message() for view in views]
        return self.catalog.UploadViews(iter(requests))

    def upload(self, upload_id: str, views: Sequence[View], *, replace: bool = False, skip_failed: bool = False,
               streams: int = 3, progress: Union[bool, OnProgress] = False) -> _upload.UploadResult:
        """Teaches many views, which become part of the catalogue together, in one revision.

        Views are durable as soon as the server has confirmed them: after an error, the same call sends the others. After
        a lost connection they are sent again by themselves, until none has arrived for about 3 s.

        Args:
          upload_id: of the upload; choose it from what is uploaded, so that an interrupted program finds it again.
          views: of stable poses that exist.
          replace: whether views replace those of the same name with other content, which are an error otherwise.
          skip_failed: whether to publish the others where a view cannot be taught; else UploadFailed is raised, and none
            is published.
          streams: how many send at the same time.
          progress: True for a bar on stderr, or a function of the views that are done and of all views.
        """
        stable_poses = set() if replace else {view.stable_pose for view in views}
        upload = _upload.Upload(self.uploads, upload_id, views, _upload.view_names(self.catalog, stable_poses), replace,
                                self._busy_retries, reporter(progress, "views"))
        return upload.run(streams, skip_failed)

    def report_outcome(self, stable_pose: str, grasp_id: str, outcome: Outcome, *, cell: Optional[str] = None,
                       count: int = 1, request_id: str = "") -> catalog_pb2.GraspOutcomeCounts:
        """Counts the outcome of a grasp; returns the counts after it. Grasps that succeed are proposed first.

        Counted once, however often it is retried. After an error it is not known whether it was counted: to send it
        again, give both calls one `request_id`, a UUID of version 4.
        """
        request = catalog_service_pb2.ReportGraspOutcomeRequest(
            name=stable_pose, grasp_id=grasp_id, outcome=catalog_pb2.GraspOutcome.Name(outcome), count=count, cell=cell,
            request_id=request_id or str(uuid.uuid4()))
        return self.catalog.ReportGraspOutcome(request).counts

    def watch(self, after_revision: Optional[int] = None, catalog_id: str = "", *, include_records: bool = False,
              heartbeat_s: float = 30.0) -> Iterator[Change]:
        """The changes of the catalogue after a revision, then those that are made, and heartbeats between them.

        Without `after_revision`, from the current one on. To go on after an error or later, give revision and id of the
        last change; OutOfRange: read all records again. Closing the iterator ends the call.
        """
        return changes_of(self.changes.WatchCatalog(change_service_pb2.WatchCatalogRequest(
            after_revision=after_revision, catalog_id=catalog_id, include_records=include_records,
            heartbeat_s=heartbeat_s)))

    def create_backup(self, *, progress: Union[bool, OnProgress] = False) -> backup_pb2.Backup:
        """Makes a backup with every write before this call. Interrupting it ends the work."""
        request = backup_service_pb2.CreateBackupRequest(request_id=str(uuid.uuid4()))
        return _backup(self.backups.CreateBackup(request), progress)

    def verify_backup(self, name: str, *, progress: Union[bool, OnProgress] = False) -> backup_pb2.Backup:
        """Reads every byte of a backup, `backups/{backup}`, and compares the checksums; DataLoss if it is damaged."""
        return _backup(self.backups.VerifyBackup(backup_service_pb2.VerifyBackupRequest(name=name)), progress)


def _release(draft: bool) -> catalog_pb2.ReleaseState:
    return catalog_pb2.RELEASE_STATE_DRAFT if draft else catalog_pb2.RELEASE_STATE_RELEASED


def _create(call: Callable[[Any], Any], request: Any, exist_ok: bool) -> None:
    try:
        call(request)
    except errors.AlreadyExists:
        if not exist_ok:
            raise


def _backup(responses: Any, progress: Union[bool, OnProgress]) -> backup_pb2.Backup:
    """That of the last message; those before it report the progress."""
    report = reporter(progress, "bytes")
    last = backup_service_pb2.CreateBackupResponse()
    try:
        for last in responses:
            report(last.done_byte_count, 0)
    finally:
        responses.cancel()
    report(last.done_byte_count, last.done_byte_count)
    return last.backup
