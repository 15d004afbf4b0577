"""teach.py SET: teaches the objects of a capture set over several streams at once, and watches the catalogue.

Interrupted? Run it again: what the server has stays.
"""
import concurrent.futures
import os
import sys

import grpc

import plant
from graspdb.v1 import (catalog_pb2, catalog_service_pb2, catalog_service_pb2_grpc, change_service_pb2,
                        change_service_pb2_grpc, upload_service_pb2, upload_service_pb2_grpc)

STREAMS = 3


def create(call, request):
    """Calls it; what exists already stays as it is."""
    try:
        call(request)
    except grpc.RpcError as error:
        if error.code() != grpc.StatusCode.ALREADY_EXISTS:
            raise


def declare(catalogue, objects):
    """Creates the objects and their stable poses, without views."""
    for shown in objects:
        create(catalogue.CreateObject, catalog_service_pb2.CreateObjectRequest(
            object_id=shown.object_id, object=catalog_pb2.Object(display_name=shown.display_name)))
        for pose in shown.stable_poses:
            symmetry_order = pose.symmetry_order if pose.HasField("symmetry_order") else None  # 0: any turn
            create(catalogue.CreateStablePose, catalog_service_pb2.CreateStablePoseRequest(
                parent=f"objects/{shown.object_id}", stable_pose_id=pose.stable_pose_id,
                stable_pose=catalog_pb2.StablePose(symmetry_order=symmetry_order, grasps=pose.grasps)))


def view_requests(upload, folder, captures):
    """A request for each capture, with the checksum of its points."""
    for capture in captures:
        cloud = plant.point_cloud(os.path.join(folder, capture.path))
        yield upload_service_pb2.WriteUploadViewsRequest(upload=upload, view=catalog_service_pb2.UploadViewsRequest(
            parent=f"objects/{capture.object_id}/stablePoses/{capture.stable_pose_id}",
            view_id=os.path.splitext(os.path.basename(capture.path))[0],
            view=catalog_pb2.View(cloud=cloud, object_pose=capture.object_pose, sensor_pose=capture.sensor_pose),
            cloud_crc32c=plant.crc32c(cloud.data)))


def send(uploads, upload, folder, captures):
    """Sends the captures over one stream; returns the number of views that are durable."""
    count = 0
    for response in uploads.WriteUploadViews(view_requests(upload, folder, captures)):
        if response.HasField("error"):
            raise RuntimeError(f"{response.view}: {response.error.message}")
        count += 1
    return count


def main():
    folder = sys.argv[1]
    captures = plant.capture_set(folder)
    channel = plant.connect("teacher")
    uploads = upload_service_pb2_grpc.UploadServiceStub(channel)
    catalogue = catalog_service_pb2_grpc.CatalogServiceStub(channel)
    status = catalogue.GetCatalogStatus(catalog_service_pb2.GetCatalogStatusRequest())
    changes = change_service_pb2_grpc.ChangeServiceStub(channel).WatchCatalog(
        change_service_pb2.WatchCatalogRequest(after_revision=status.catalog_revision, catalog_id=status.catalog_id))

    declare(catalogue, captures.objects)
    name = os.path.basename(os.path.normpath(folder))
    create(uploads.CreateUpload, upload_service_pb2.CreateUploadRequest(upload_id=name))
    with concurrent.futures.ThreadPoolExecutor(STREAMS) as streams:
        parts = [captures.captures[i::STREAMS] for i in range(STREAMS)]
        sent = list(streams.map(lambda part: send(uploads, f"uploads/{name}", folder, part), parts))
    committed = uploads.CommitUpload(upload_service_pb2.CommitUploadRequest(name=f"uploads/{name}"))
    print(f"{'+'.join(map(str, sent))} views sent, {committed.created_count} new in revision {committed.commit_revision}")

    for response in changes:
        for change in response.changes:
            print(f"{response.catalog_revision:4} {change_service_pb2.ChangeKind.Name(change.kind)} {change.name}")
        if response.catalog_revision >= committed.commit_revision and not response.continued:
            break
    changes.cancel()


main()
