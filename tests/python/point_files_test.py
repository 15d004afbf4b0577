"""PCD and PLY files, also damaged ones."""
import os
import struct
import subprocess
import unittest

import numpy as np

import graspdb
from server import BIN, Folder

POINTS = np.array([[0.1, -0.2, 0.7], [np.nan, 0, 0], [1e-3, 2.5, 3], [-0.5, 0.25, 1]], np.float32)
HEADER = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {}\nHEIGHT {}\n" \
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA {}\n"
PLY = "ply\nformat {} 1.0\ncomment of a test\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n" \
      "property uchar red\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"


class PointFiles(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(Folder())

    def read(self, content, name="scan.pcd"):
        path = self.folder.path(name)
        with open(path, "wb") as file:
            file.write(content)
        return graspdb.read_points(path)

    def assert_refused(self, content, advice, name="scan.pcd"):
        with self.assertRaisesRegex(ValueError, f"{name} .*{advice}"):
            self.read(content, name)

    def test_pcd_binary(self):
        file = self.read(HEADER.format(4, 1, "binary").encode() + POINTS.tobytes())
        np.testing.assert_array_equal(file.points, POINTS)
        self.assertIsNone(file.sensor_pose)

    def test_pcd_organised(self):
        file = self.read(HEADER.format(2, 2, "binary").encode() + POINTS.tobytes())
        np.testing.assert_array_equal(file.points, POINTS.reshape(2, 2, 3))

    def test_pcd_ascii(self):
        text = "\n".join(" ".join(map(str, point)) for point in POINTS)
        np.testing.assert_array_equal(self.read(HEADER.format(4, 1, "ascii").encode() + text.encode()).points, POINTS)

    def test_pcd_with_other_fields(self):
        header = (HEADER.format(4, 1, "binary").replace("x y z", "intensity z normal y x")
                  .replace("4 4 4", "2 8 4 4 4").replace("F F F", "U F F F F").replace("1 1 1", "1 1 3 1 1"))
        body = b"".join(struct.pack("<Hdfffff", 7, z, 1, 2, 3, y, x) for x, y, z in POINTS)
        np.testing.assert_array_equal(self.read(header.encode() + body).points, POINTS)

    def test_pcd_viewpoint(self):
        header = HEADER.format(4, 1, "binary").replace("0 0 0 1 0 0 0", "1 2 3 0.5 0.5 0.5 0.5")
        np.testing.assert_allclose(self.read(header.encode() + POINTS.tobytes()).sensor_pose,
                                   [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]], atol=1e-12)
        for words in ("1 2 3", "0 0 0 2 0 0 0", "0 0 0 nan 0 0 0", "a b c d e f g"):
            header = HEADER.format(4, 1, "binary").replace("0 0 0 1 0 0 0", words)
            self.assert_refused(header.encode() + POINTS.tobytes(), "VIEWPOINT")

    def test_pcd_compressed_by_graspdb(self):
        subprocess.run([os.path.join(BIN, "graspdb"), "simulate", "--parts", "flange", "--random", "1", "--out", "set"],
                       cwd=self.folder.name, check=True, capture_output=True)
        (name,) = os.listdir(self.folder.path("set", "clouds"))
        with open(self.folder.path("set", "clouds", name), "rb") as file:
            content = file.read()
        self.assertIn(b"DATA binary_compressed", content[:400])
        points = self.read(content).points
        measured = points[np.isfinite(points).all(axis=-1) & (points != 0).any(axis=-1)]
        self.assertGreater(len(measured), 1000)
        self.assertTrue(((measured[:, 2] > 0.3) & (measured[:, 2] < 3)).all())
        self.assert_refused(content[:-100], "ends before its")
        self.assert_refused(content[:-2000] + bytes(2000), "damaged")

    def test_pcd_compressed_repetitions(self):
        # Eight literals, of which the last four then repeat 40 times, overlapping themselves.
        body = bytes([7]) + bytes(range(8)) + bytes([7 << 5, 160 - 9, 3])
        header = HEADER.format(14, 1, "binary_compressed").encode()
        points = self.read(header + struct.pack("<II", len(body), 168) + body).points
        self.assertEqual(points.T.copy().tobytes(), bytes(range(8)) + bytes(range(4, 8)) * 40)
        backwards = bytes([0, 1, 7 << 5, 255, 200])
        self.assert_refused(header + struct.pack("<II", 5, 168) + backwards, "damaged")

    def test_ply_binary(self):
        body = b"".join(point.tobytes() + b"\xff" for point in POINTS)
        np.testing.assert_array_equal(self.read(PLY.format("binary_little_endian", 4).encode() + body, "a.ply").points, POINTS)
        body = b"".join(point.astype(">f4").tobytes() + b"\xff" for point in POINTS)
        np.testing.assert_array_equal(self.read(PLY.format("binary_big_endian", 4).encode() + body, "a.ply").points, POINTS)

    def test_ply_ascii(self):
        body = "".join(" ".join(map(str, point)) + " 255\n" for point in POINTS)
        np.testing.assert_array_equal(self.read((PLY.format("ascii", 4) + body).encode(), "a.ply").points, POINTS)

    def test_a_copy_in_text_mode_is_refused(self):
        points = np.frombuffer(b"\n" * 48, np.float32).tobytes()
        copied = points.replace(b"\n", b"\r\n")
        self.read(HEADER.format(4, 1, "binary").encode() + points)
        self.read(HEADER.format(4, 1, "binary").encode() + points + bytes(4096))  # the padding of PCL
        self.assert_refused(HEADER.format(4, 1, "binary").encode() + copied, "text mode")
        self.assert_refused(PLY.format("binary_little_endian", 3).encode() + copied, "text mode", "a.ply")
        packed = struct.pack("<II", 50, 48) + bytes([31]) + points[:32] + bytes([15]) + points[:16]
        self.read(HEADER.format(4, 1, "binary_compressed").encode() + packed)
        self.assert_refused(HEADER.format(4, 1, "binary_compressed").encode() + packed.replace(b"\n", b"\r\n"),
                            "text mode")

    def test_rows_have_the_numbers_of_the_header(self):
        for row in (b"1 2 3 4 5\n", b"1 2 3\n"):
            self.assert_refused(PLY.format("ascii", 2).encode() + b"1 2 3 4\n" + row * 2, "more or fewer", "a.ply")
        self.assert_refused(HEADER.format(4, 1, "ascii").encode() + b"1 2 3 4\n" * 4, "more or fewer")

    def test_sizes_of_a_header_are_compared_with_the_file(self):
        for size in (5, 10 ** 6, 10 ** 15, 10 ** 30):
            for encoding in ("ascii", "binary", "binary_compressed"):
                self.assert_refused(HEADER.format(size, 1, encoding).encode() + POINTS.tobytes(), "ends before its")
            body = b"".join(point.tobytes() + b"\xff" for point in POINTS)
            self.assert_refused(PLY.format("binary_little_endian", size).encode() + body, "ends before its", "a.ply")
            self.assert_refused(PLY.format("ascii", size).encode() + b"1 2 3 4\n" * 4, "ends before its", "a.ply")

    def test_what_is_not_understood_is_refused_with_advice(self):
        header = HEADER.format(4, 1, "binary")
        body = POINTS.tobytes()
        for content, advice in (
                (b"", "complete PCD header"),
                (b"FIELDS x y z\n", "complete PCD header"),
                (header.replace("WIDTH 4\n", "").encode() + body, "complete PCD header"),
                (header.replace("WIDTH 4", "WIDTH four").encode() + body, "complete PCD header"),
                (header.replace("WIDTH 4", "WIDTH -4").encode() + body, "do not fit"),
                (header.replace("COUNT 1 1 1", "COUNT 1 1").encode() + body, "do not fit"),
                (header.replace("COUNT 1 1 1", "COUNT 1 1 0").encode() + body, "do not fit"),
                (header.replace("x y z", "x y i").encode() + body, "TYPE F"),
                (header.replace("x y z", "x x z").encode() + body, "TYPE F"),
                (header.replace("F F F", "F F U").encode() + body, "TYPE F"),
                (header.replace("SIZE 4", "SIZE 2").encode() + body, "TYPE F"),
                (header.replace("binary", "zstd").encode() + body, "save it as binary"),
                (header.replace("binary", "ascii").encode() + b"a b c\n" * 4, "in place of numbers")):
            self.assert_refused(content, advice)
        header = PLY.format("binary_little_endian", 4)
        for content, advice in (
                ("ply\n", "complete PLY header"),
                (header.replace("end_header", ""), "complete PLY header"),
                (header.replace("element vertex", "element edge"), "vertex first"),
                (header.replace("uchar red", "list uchar int red"), "lists"),
                (header.replace("float z", "half z"), "unknown properties"),
                (header.replace("float z", "float depth"), "x, y and z"),
                (header.replace("binary_little_endian", "binary_middle_endian"), "binary_little_endian")):
            self.assert_refused(content.encode() + bytes(400), advice, "a.ply")
        self.assert_refused(b"1 2 3\n", "neither PCD nor PLY", "a.xyz")

    def test_a_damaged_file_is_read_or_refused(self):
        random = np.random.default_rng(3)
        whole = [HEADER.format(4, 1, encoding).encode() + POINTS.tobytes() for encoding in ("binary", "ascii")]
        whole.append(HEADER.format(14, 1, "binary_compressed").encode() + struct.pack("<II", 12, 168)
                     + bytes([7]) + bytes(range(8)) + bytes([7 << 5, 151, 3]))
        whole.append(PLY.format("binary_little_endian", 4).encode() + bytes(52))
        whole.append(PLY.format("ascii", 4).encode() + b"1 2 3 4\n" * 4)
        for _ in range(500):
            content = bytearray(whole[random.integers(len(whole))])
            for _ in range(random.integers(1, 4)):
                content[random.integers(len(content))] = random.integers(256)
            try:
                points = self.read(bytes(content[:random.integers(1, len(content) + 1)])).points
            except ValueError as error:
                self.assertIn("scan.pcd ", str(error))
            else:
                self.assertEqual((points.dtype, points.shape[-1]), (np.float32, 3))
                self.assertLess(points.size, 1000)


if __name__ == "__main__":
    unittest.main()
