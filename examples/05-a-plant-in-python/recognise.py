"""recognise.py SET OUT: recognises the frames of a capture set, and writes the responses to OUT, one a line."""
import os
import sys

import plant
from graspdb.v1 import recognition_pb2, recognition_service_pb2, recognition_service_pb2_grpc


def main():
    folder, out = sys.argv[1:]
    recognition = recognition_service_pb2_grpc.RecognitionServiceStub(plant.connect("press-3"))
    right = 0
    captures = plant.capture_set(folder).captures
    with open(out, "w", encoding="ascii") as responses:
        for capture in captures:
            response = recognition.Recognize(recognition_service_pb2.RecognizeRequest(
                cloud=plant.point_cloud(os.path.join(folder, capture.path)), sensor_pose=capture.sensor_pose,
                omit_timings=True), timeout=30)
            found = [detection for detection in response.detections if detection.status == recognition_pb2.OK]
            for detection in found:
                position = detection.refined_pose.position
                print(f"{capture.path}: {detection.object} ({detection.score:.2f}) at "
                      f"{position.x:.3f} {position.y:.3f} {position.z:.3f} m, {len(detection.grasps)} grasps")
            right += [detection.object for detection in found] == [f"objects/{capture.object_id}"]
            print(response.SerializeToString(deterministic=True).hex(), file=responses)
    print(f"{right} of {len(captures)} right")
    sys.exit(0 if right == len(captures) else 1)


main()
