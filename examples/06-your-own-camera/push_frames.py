"""push_frames.py PORT FILE...: pushes frames to the agent of a cell, one after the other, until it is ended."""
import itertools
import sys
import time

import graspdb


def grab(file):
    """A frame of the camera, and when its exposure started; here of a file. README.md has those of several SDKs."""
    captured = time.time()
    return {"cloud": graspdb.read_points(file).points}, captured


port, *files = sys.argv[1:]
with graspdb.Pusher(f"127.0.0.1:{port}", camera="files") as pusher:
    for file in itertools.cycle(files):
        frame, captured = grab(file)
        try:
            pusher.push(**frame, captured=captured)
        except graspdb.errors.Unavailable as error:
            print(error, file=sys.stderr)
            time.sleep(1)
