"""Frames that a program pushes to the agent of a cell, which recognises them."""
import contextlib
import os
import socket
import subprocess
import sys
import time
import unittest

import numpy as np

import graspdb
from server import BIN, Folder, Server

SOURCE = os.environ["GRASPDB"]
FRAMES = os.path.join(os.environ.get("GRASPDB_SHARED_DATA") or os.path.join(SOURCE, "..", "shared", "data"), "real_frames")
EXAMPLE = os.path.join(SOURCE, "examples", "06-your-own-camera", "push_frames.py")


class Agent:
    """A graspdb-cell whose camera is pushed, in `with`; `lines` has what it printed, such as "camera"."""

    def __init__(self, folder, server, *flags):
        self._log = open(folder.path("agent.log"), "ab")
        self._process = subprocess.Popen(
            [os.path.join(BIN, "graspdb-cell"), "--server", server, "--cell", "press-3", "--sensor", "push:0",
             "--gri", "", "--line", "127.0.0.1:0", "--health", "", "--cell-period", "0.1", *flags],
            stdout=subprocess.PIPE, stderr=self._log, text=True)
        self.camera = self.line = None
        for line in self._process.stdout:
            if line.startswith("camera: frames pushed to "):
                self.camera = line.split()[-1]
            if line.startswith("line protocol on "):
                self.line = line.split()[-1]
            if line.startswith("ready"):
                return
        self.stop()
        with open(self._log.name, encoding="utf-8") as log:
            raise RuntimeError(log.read())

    def reply(self, request):
        """The reply to a line."""
        host, port = self.line.rsplit(":", 1)
        with socket.create_connection((host, int(port)), timeout=60) as robot, robot.makefile("rw") as stream:
            stream.write(request + "\n")
            stream.flush()
            return stream.readline().strip()

    def stop(self):
        self._process.terminate()
        self._process.wait()
        self._process.stdout.close()
        self._log.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


class Pushing(unittest.TestCase):
    def test_errors_say_what_to_do(self):
        folder = self.enterContext(Folder())
        with Agent(folder, "127.0.0.1:1") as agent:
            pusher = self.enterContext(graspdb.Pusher(agent.camera, camera="left"))
            depth = np.full((12, 16), 800, np.uint16)
            camera = graspdb.Intrinsics(20, 20, 8, 6)
            pusher.push(depth=depth, intrinsics=camera, captured=time.time())
            with self.assertRaisesRegex(graspdb.errors.InvalidArgument, "in the future"):
                pusher.push(depth=depth, intrinsics=camera, captured=time.time() + 60)
            with self.assertRaisesRegex(graspdb.errors.InvalidArgument, "millimetres"):
                pusher.push(np.full((4, 3), 800.0), captured=time.time())
            with self.assertRaisesRegex(graspdb.errors.Aborted, "newer"):
                pusher.push(depth=depth, intrinsics=camera, captured=time.time() - 10)
            other = self.enterContext(graspdb.Pusher(agent.camera, camera="right"))
            with self.assertRaisesRegex(graspdb.errors.FailedPrecondition, "camera left"):
                other.push(depth=depth, intrinsics=camera, captured=time.time())
        with self.assertRaisesRegex(graspdb.errors.Unavailable, "--sensor push:PORT"):
            pusher.push(depth=depth, intrinsics=camera, captured=time.time())

    @unittest.skipUnless(os.path.isdir(FRAMES), f"needs the real frames in {FRAMES}; set GRASPDB_SHARED_DATA")
    def test_a_robot_gets_the_pose_of_an_object_in_pushed_frames_of_a_real_camera(self):
        folder = self.enterContext(Folder())
        server = self.enterContext(Server(folder))
        program = [os.path.join(BIN, "graspdb"), "--server", server.address]
        subprocess.run(program + ["teach", "mustard", "--mesh", os.path.join(FRAMES, "meshes", "mustard_bottle.ply"),
                                  "--unit", "m"], check=True, capture_output=True)
        frame = os.path.join(FRAMES, "frames", "nv4.pcd")
        client = self.enterContext(graspdb.Client(server.address))
        direct = client.recognize(frame)
        (expected,) = [each.pose for each in direct.detections if each.object == "objects/mustard"]
        pose = direct.message.sensor_pose
        subprocess.run(program + ["cells", "set", "press-3", "--sensor-pose", ",".join(
            repr(value) for value in (pose.position.x, pose.position.y, pose.position.z, pose.orientation.x,
                                      pose.orientation.y, pose.orientation.z, pose.orientation.w))],
                       check=True, capture_output=True)
        agent = self.enterContext(Agent(folder, server.address, "--job", "1 object=mustard primary=object limit=60s"))
        with pushing(agent.camera, frame):
            # Retried, since the program may not have pushed its first frame.
            end = time.monotonic() + 60
            reply = agent.reply("FORMAT ABB RUN 1")
            while reply.startswith("ERR -5") and time.monotonic() < end:
                reply = agent.reply("FORMAT ABB RUN 1")
        self.assertRegex(reply, "^OK ")
        position = np.array(reply.split()[3:6], float) / 1000
        np.testing.assert_allclose(position, expected[:3, 3], atol=1e-4)


@contextlib.contextmanager
def pushing(address, *files):
    """Runs the example."""
    process = subprocess.Popen([sys.executable, EXAMPLE, address.rsplit(":", 1)[1], *files])
    try:
        yield
    finally:
        process.terminate()
        process.wait()


if __name__ == "__main__":
    unittest.main()
