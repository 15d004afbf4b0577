"""Sends one depth image to a graspdb server and prints what stands on the table and how to grasp it.

recognize.py [HOST:PORT]
"""
import sys

import numpy as np

import graspdb

CAMERA = graspdb.Intrinsics(fx=300, fy=300, cx=159.5, cy=119.5)


def capture():
    """In the place of a camera: a box of 80 x 50 x 30 mm on a table, as 240 rows of 320 millimetres.

    The camera is 0.45 m before the box and 0.54 m above the table, and looks at the foot of the box.
    """
    eye, half_size, yaw = np.array([0, -0.45, 0.54]), np.array([0.04, 0.025, 0.015]), np.radians(25)
    forward = -eye / np.linalg.norm(eye)
    right, down = np.array([1, 0, 0]), np.cross(forward, [1, 0, 0])
    v, u = np.indices((240, 320))
    rays = (forward + (u - CAMERA.cx)[..., None] / CAMERA.fx * right + (v - CAMERA.cy)[..., None] / CAMERA.fy * down)
    table = np.where(rays[..., 2] < 0, -eye[2] / rays[..., 2], np.inf)
    # Where a ray enters the box, in its frame.
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    ends = np.stack([([0, 0, half_size[2]] + sign * half_size - eye @ turn) / (rays @ turn) for sign in (-1, 1)])
    near, far = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
    depth = np.minimum(table, np.where((near > 0) & (near < far), near, np.inf))
    return np.round(1000 * np.minimum(depth, 65)).astype(np.uint16)


def main():
    with graspdb.Client(*sys.argv[1:]) as client:
        result = client.recognize(depth=capture(), intrinsics=CAMERA)
    for detection in result.detections:
        if detection.status is graspdb.Status.OK:
            x, y, z = detection.pose[:3, 3]
            print(f"{detection.object} ({detection.score:.2f}) at {x:.3f} {y:.3f} {z:.3f} m, {len(detection.grasps)} grasps")
    sys.exit(0 if result.status is graspdb.Status.OK else 1)


if __name__ == "__main__":
    main()
