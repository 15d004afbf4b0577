"""The Python of README.md and docs/python.md runs as it stands, against a server of its own."""
import contextlib
import io
import os
import re
import subprocess
import unittest

import numpy as np

import graspdb
import scenes
from server import BIN, Folder, Server


def python_blocks(document):
    """By the heading above each; the last one under a heading wins."""
    with open(os.path.join(os.environ["GRASPDB"], document), encoding="utf-8") as file:
        text = file.read()
    blocks = {}
    for section in re.split(r"^#+ ", text, flags=re.MULTILINE):
        for code in re.findall(r"^```python\n(.*?)^```$", section, re.MULTILINE | re.DOTALL):
            blocks[section.partition("\n")[0]] = code
    return blocks


class Readme(unittest.TestCase):
    def test_its_five_lines_recognise_a_scan(self):
        (code,) = python_blocks("README.md").values()
        self.assertEqual(len([line for line in code.splitlines() if line.strip()]), 5)
        self.assertIn("127.0.0.1:50051", code)
        folder = self.enterContext(Folder())
        server = self.enterContext(Server(folder))
        program = [os.path.join(BIN, "graspdb"), "--server", server.address]
        for arguments in (["simulate", "--parts", "flange", "--step", "30", "--out", "teach"], ["import", "teach"],
                          ["simulate", "--parts", "flange", "--random", "1", "--seed", "7", "--out", "scene"]):
            subprocess.run(program + arguments, cwd=folder.name, check=True, capture_output=True)
        (name,) = os.listdir(folder.path("scene", "clouds"))
        os.rename(folder.path("scene", "clouds", name), folder.path("scan.pcd"))
        code = code.replace("127.0.0.1:50051", server.address)
        with contextlib.chdir(folder.name), contextlib.redirect_stdout(io.StringIO()) as text:
            exec(compile(code, "README.md", "exec"), {})  # pylint: disable=exec-used
        self.assertRegex(text.getvalue(), r"^objects/flange 0\.\d+ \[\[")

    def test_those_of_package_and_guide_are_the_same(self):
        (code,) = python_blocks("README.md").values()
        self.assertEqual(python_blocks("docs/python.md")["Python client"], code)
        self.assertIn(code.strip(), "\n".join(line[4:] for line in graspdb.__doc__.splitlines()))

    def test_the_guide_teaches_recognises_and_deletes(self):
        blocks = python_blocks("docs/python.md")
        for code in blocks.values():
            compile(code, "docs/python.md", "exec")
        server = self.enterContext(Server(self.enterContext(Folder())))
        client = self.enterContext(graspdb.Client(server.address))
        poses = [scenes.pose(yaw_deg=yaw) for yaw in (0, 120, 240)]
        names = {"client": client, "graspdb": graspdb, "camera": scenes.CAMERA, "sensor": scenes.sensor_pose(),
                 "captures": [(scenes.depth(scenes.BRACKET, pose), pose) for pose in poses],
                 "image": scenes.depth(scenes.BRACKET, poses[0]), "tcp_pose": np.diag([1.0, -1, -1, 1])}
        with contextlib.redirect_stderr(io.StringIO()) as text:
            exec(blocks["Teach"], names)  # pylint: disable=exec-used
        self.assertIn("3/3 views", text.getvalue())
        exec(blocks["Recognise"].replace(', cell="cells/press-3"', ""), names)  # pylint: disable=exec-used
        self.assertEqual(names["result"].detections[0].object, "objects/bracket")
        exec(blocks["All other calls"], names)  # pylint: disable=exec-used
        self.assertEqual(client.status().object_count, 0)


if __name__ == "__main__":
    unittest.main()
