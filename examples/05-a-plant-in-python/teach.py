"""teach.py SET: teaches the objects of a capture set over several streams at once, and watches the catalogue.

Interrupted? Run it again: what the server has stays.
"""
import os
import sys

import graspdb
import plant
from graspdb.geometry import matrix_of_pose


def declare(client, objects):
    """Creates the objects and their stable poses, without views; what exists already stays as it is."""
    for shown in objects:
        name = client.create_object(shown.object_id, display_name=shown.display_name, exist_ok=True)
        for pose in shown.stable_poses:
            symmetry_order = pose.symmetry_order if pose.HasField("symmetry_order") else 1  # 0: any turn
            client.create_stable_pose(name, pose.stable_pose_id, symmetry_order=symmetry_order, grasps=pose.grasps,
                                      exist_ok=True)


def main():
    folder = sys.argv[1]
    captures = plant.capture_set(folder)
    with plant.connect("teacher") as client:
        status = client.status()
        changes = client.watch(status.catalog_revision, status.catalog_id)
        declare(client, captures.objects)
        views = [graspdb.View(f"objects/{capture.object_id}/stablePoses/{capture.stable_pose_id}",
                              cloud=os.path.join(folder, capture.path), object_pose=matrix_of_pose(capture.object_pose),
                              sensor_pose=matrix_of_pose(capture.sensor_pose)) for capture in captures.captures]
        result = client.upload(os.path.basename(os.path.normpath(folder)), views, progress=True)
        print(f"{result.created} of {len(views)} views new in revision {result.catalog_revision}")
        for change in changes:
            for resource in change.resources:
                print(f"{change.catalog_revision:4} {resource.kind.name} {resource.name}")
            if change.catalog_revision >= result.catalog_revision:
                break


main()
