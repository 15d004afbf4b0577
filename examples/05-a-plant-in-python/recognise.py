"""recognise.py SET OUT: recognises the frames of a capture set, and writes the responses to OUT, one a line."""
import os
import sys

import graspdb
import plant
from graspdb.geometry import matrix_of_pose


def main():
    folder, out = sys.argv[1:]
    captures = plant.capture_set(folder).captures
    right = 0
    with plant.connect("press-3") as client, open(out, "w", encoding="ascii") as responses:
        for capture in captures:
            result = client.recognize(os.path.join(folder, capture.path), omit_timings=True,
                                      sensor_pose=matrix_of_pose(capture.sensor_pose))
            found = [detection for detection in result.detections if detection.status is graspdb.Status.OK]
            for detection in found:
                x, y, z = detection.pose[:3, 3]
                print(f"{capture.path}: {detection.object} ({detection.score:.2f}) at {x:.3f} {y:.3f} {z:.3f} m, "
                      f"{len(detection.grasps)} grasps")
            right += [detection.object for detection in found] == [f"objects/{capture.object_id}"]
            print(result.message.SerializeToString(deterministic=True).hex(), file=responses)
    print(f"{right} of {len(captures)} right")
    sys.exit(0 if right == len(captures) else 1)


main()
