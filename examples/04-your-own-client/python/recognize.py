"""Sends one depth image to a graspdb server and prints what stands on the table and how to grasp it.

recognize.py [HOST:PORT]
"""
import array
import math
import sys

import grpc

from graspdb.v1 import geometry_pb2, recognition_pb2, recognition_service_pb2, recognition_service_pb2_grpc

CAMERA = geometry_pb2.CameraIntrinsics(width=320, height=240, fx=300, fy=300, cx=159.5, cy=119.5)


def capture():
    """In the place of a camera: a box of 80 x 50 x 30 mm on a table, as rows of millimetres.

    The camera is 0.45 m before the box and 0.54 m above the table, and looks at the foot of the box.
    """
    eye, half_size, yaw = (0, -0.45, 0.54), (0.04, 0.025, 0.015), math.radians(25)
    length = math.hypot(eye[1], eye[2])
    forward = (0, -eye[1] / length, -eye[2] / length)
    depths = array.array("H")
    for v in range(CAMERA.height):
        for u in range(CAMERA.width):
            right, down = (u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy
            ray = (right, forward[1] + forward[2] * down, forward[2] - forward[1] * down)
            depth = -eye[2] / ray[2] if ray[2] < 0 else math.inf  # the table
            depths.append(round(1000 * min(depth, box_depth(eye, ray, half_size, yaw), 65)))
    if sys.byteorder == "big":
        depths.byteswap()
    return depths.tobytes()


def box_depth(eye, ray, half_size, yaw):
    """Where a ray enters an upright box that stands at the origin; infinity where it passes."""
    def turned(p):
        return (p[0] * math.cos(yaw) + p[1] * math.sin(yaw), p[1] * math.cos(yaw) - p[0] * math.sin(yaw), p[2])

    near, far = 0, math.inf
    for start, step, half, middle in zip(turned(eye), turned(ray), half_size, (0, 0, half_size[2])):
        if abs(step) < 1e-12:
            step = 1e-12
        ends = sorted(((middle - half - start) / step, (middle + half - start) / step))
        near, far = max(near, ends[0]), min(far, ends[1])
    return near if near < far else math.inf


def main():
    server = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:50051"
    recognition = recognition_service_pb2_grpc.RecognitionServiceStub(grpc.insecure_channel(server))
    image = geometry_pb2.DepthImage(intrinsics=CAMERA, data=capture())
    answer = recognition.Recognize(recognition_service_pb2.RecognizeRequest(depth_image=image), timeout=10)
    for detection in answer.detections:
        if detection.status != recognition_pb2.OK:
            continue
        position = detection.refined_pose.position
        print(f"{detection.object} ({detection.score:.2f}) at "
              f"{position.x:.3f} {position.y:.3f} {position.z:.3f} m, {len(detection.grasps)} grasps")
    sys.exit(0 if answer.status == recognition_pb2.OK else 1)


main()
