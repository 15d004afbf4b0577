"""bigbird_test.py PROGRAMS: graspdb-bigbird on folders that are rendered here."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

PROGRAMS = sys.argv.pop(1)
sys.dont_write_bytecode = True
sys.path.insert(0, PROGRAMS)
from graspdb_bigbird_files import pcd_points, write_pcd  # noqa: E402

SHAPE, FOCAL, CENTRE = (480, 640), 570.0, (319.5, 239.5)
SIZES = {"flat": (0.10, 0.06, 0.03), "tall": (0.06, 0.04, 0.09)}
MIDDLE = numpy.array((0.02, -0.015))  # of the box, in the table's frame with z up
FLIP = numpy.diag((1.0, -1, -1, 1))
DEPTH_SCALE = 1.02


def turn(axis, degrees, position=(0, 0, 0)):
    a, b = ((axis + 1) % 3, (axis + 2) % 3)
    out = numpy.eye(4)
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    out[a, a], out[a, b], out[b, a], out[b, b] = c, -s, s, c
    out[:3, 3] = position
    return out


# T_lab_sensor: 0.6 m away, looking 50 degrees below the horizon at the table's middle.
LAB_RGB = turn(0, -140) @ turn(2, 0, (0, 0, -0.6))
RGB_IR = turn(1, 1.5, (-0.025, 0.003, 0.002))
RGB_REFERENCE = turn(0, 30, (0.1, 0.2, -0.1))  # T_NP3_NP5


def lab_table(degrees):
    return turn(2, 20 + degrees)


def render(lab_sensor, degrees, size):
    """Depth in metres of a box on the turning table and of the table, and where the box is."""
    v, u = numpy.mgrid[0:SHAPE[0], 0:SHAPE[1]]
    rays = numpy.stack(((u - CENTRE[0]) / FOCAL, (v - CENTRE[1]) / FOCAL, numpy.ones(SHAPE)), axis=-1)
    table_sensor = numpy.linalg.inv(lab_table(degrees)) @ lab_sensor
    start, steps = table_sensor[:3, 3], rays @ table_sensor[:3, :3].T
    low = numpy.array((*(MIDDLE - numpy.array(size[:2]) / 2), 0))
    with numpy.errstate(divide="ignore"):
        a, b = (low - start) / steps, (low + size - start) / steps
        table = numpy.where(steps[..., 2] < 0, -start[2] / steps[..., 2], 0)
    near, far = numpy.minimum(a, b).max(axis=-1), numpy.maximum(a, b).min(axis=-1)
    on_box = (near < far) & (near > 0)
    depth = numpy.where(on_box, near, numpy.where(table < 2, table, 0))
    return depth, rays * depth[..., None], on_box


def write_h5(path, **datasets):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with h5py.File(path, "w") as file:
        for name, values in datasets.items():
            file[name] = values


def write_object(folder, name, step_deg, clouds=True, upside_down=False, mesh=False):
    flip = FLIP if upside_down else numpy.eye(4)
    path = os.path.join(folder, name)
    k = numpy.array(((FOCAL, 0, CENTRE[0]), (0, FOCAL, CENTRE[1]), (0, 0, 1)))
    write_h5(os.path.join(path, "calibration.h5"), H_NP3_from_NP5=RGB_REFERENCE,
             H_NP3_ir_from_NP5=numpy.linalg.inv(RGB_IR) @ RGB_REFERENCE, NP3_ir_K=k, NP3_ir_d=numpy.zeros((5, 1)),
             NP3_ir_depth_scale=numpy.array(DEPTH_SCALE))
    os.makedirs(os.path.join(path, "clouds"), exist_ok=True)
    for degrees in range(0, 360, step_deg):
        table_reference = flip @ numpy.linalg.inv(lab_table(degrees)) @ LAB_RGB @ RGB_REFERENCE
        write_h5(os.path.join(path, "poses", f"NP5_{degrees}_pose.h5"), H_table_from_reference_camera=table_reference)
        depth, points, on_box = render(LAB_RGB @ RGB_IR, degrees, SIZES[name])
        if clouds:
            in_rgb = points[on_box] @ RGB_IR[:3, :3].T + RGB_IR[:3, 3]
            write_pcd(os.path.join(path, "clouds", f"NP3_{degrees}.pcd"), in_rgb)
        else:
            write_h5(os.path.join(path, f"NP3_{degrees}.h5"), depth=numpy.rint(depth / (1e-4 * DEPTH_SCALE)))
    if mesh:
        write_mesh(os.path.join(path, "textured_meshes", "optimized_poisson_textured_mesh.ply"), SIZES[name], flip)


def write_mesh(path, size, flip, lift=0):
    corners = numpy.array([(x, y, z) for z in (0, 1) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]) * size
    corners = (corners + (*MIDDLE, lift)) @ flip[:3, :3].T
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="ascii") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 6\nproperty list uchar int vertex_indices\nend_header\n")
        file.writelines(" ".join(map(str, corner)) + "\n" for corner in corners)
        file.writelines("4 " + " ".join(map(str, quad)) + "\n" for quad in quads)


def matrix(pose):
    x, y, z, w = (pose["orientation"].get(axis, 0) for axis in "xyzw")
    out = numpy.eye(4)
    out[:3, :3] = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                   (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                   (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    out[:3, 3] = [pose["position"].get(axis, 0) for axis in "xyz"]
    return out


class BigBird(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source, self.out = os.path.join(folder.name, "bigbird"), os.path.join(folder.name, "set")

    def run_program(self, *options, source=None):
        command = [os.path.join(PROGRAMS, "graspdb-bigbird"), source or self.source, self.out, *options]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def convert(self, *options, source=None):
        run = self.run_program(*options, source=source)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(os.path.join(self.out, "captures.json"), encoding="utf-8") as file:
            return json.load(file)

    def expect_failure(self, text, *options):
        run = self.run_program(*options)
        self.assertEqual(run.returncode, 1)
        self.assertIn(text, run.stderr)

    def expect_frames(self, document, name, middle):
        sensors = [matrix(capture["sensorPose"]) for capture in document["captures"]]
        for capture, sensor in zip(document["captures"], sensors):
            self.assertGreater(sensor[2, 3], 0.1)
            numpy.testing.assert_allclose(sensor, sensors[0], atol=1e-6)  # cameras stand still
            points = pcd_points(os.path.join(self.out, capture["path"]))
            object_sensor = numpy.linalg.inv(matrix(capture["objectPose"])) @ sensor
            points = points @ object_sensor[:3, :3].T + object_sensor[:3, 3]
            points = points[points[:, 2] > 0.003]
            self.assertGreater(len(points), 300)
            half = numpy.array(SIZES[name]) / 2
            outside = numpy.abs(points - (*middle, half[2])) - half
            self.assertLess(numpy.abs(outside.max(axis=1)).max(), 0.0015)  # on the surface of the box

    def test_points_lie_on_the_object(self):
        for clouds in (True, False):
            for upside_down in (False, True):
                with self.subTest(clouds=clouds, upside_down=upside_down), tempfile.TemporaryDirectory() as folder:
                    self.source, self.out = os.path.join(folder, "bigbird"), os.path.join(folder, "set")
                    write_object(self.source, "tall", 90, clouds, upside_down)
                    document = self.convert("--teach-step-deg", "180")
                    self.expect_frames(document, "tall", MIDDLE)
                    self.assertEqual([c["segmented"] for c in document["captures"]], [clouds] * 4)
                    self.assertEqual("regionOfInterest" in document, not clouds)

    def test_an_object_with_a_mesh_has_its_origin_below_the_middle(self):
        for upside_down in (False, True):
            with self.subTest(upside_down=upside_down), tempfile.TemporaryDirectory() as folder:
                self.source, self.out = os.path.join(folder, "bigbird"), os.path.join(folder, "set")
                write_object(self.source, "flat", 90, upside_down=upside_down, mesh=True)
                self.expect_frames(self.convert("--teach-step-deg", "180"), "flat", (0, 0))
                with open(os.path.join(self.out, "models/flat.ply"), encoding="ascii") as file:
                    lines = file.read().split("\n")
                corners = numpy.array([line.split() for line in lines[9:17]], dtype=float)
                numpy.testing.assert_allclose(corners.max(axis=0), (0.05, 0.03, 0.03), atol=1e-6)
                numpy.testing.assert_allclose(corners.min(axis=0), (-0.05, -0.03, 0), atol=1e-6)

    def test_eval_recognizes_the_turns_between_the_taught_ones(self):
        for name in SIZES:
            write_object(self.source, name, 30, mesh=True)
        self.convert("--teach-step-deg", "60")
        run = subprocess.run([os.path.join(PROGRAMS, "graspdb"), "eval", self.out], capture_output=True, text=True,
                             check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stdout, r"captures +12 .*object 100.00 %.*pose 100.00 %")

    def test_objects_and_turns_are_chosen(self):
        for name in SIZES:
            write_object(self.source, name, 45)
        document = self.convert("--objects", "flat", "--teach-step-deg", "90")
        self.assertEqual([o["objectId"] for o in document["objects"]], ["flat"])
        self.assertEqual([c["split"] for c in document["captures"]], ["TEACH", "QUERY"] * 4)

    def test_the_folder_of_one_object_is_enough(self):
        write_object(self.source, "flat", 45)
        document = self.convert("--teach-step-deg", "90", source=os.path.join(self.source, "flat", ""))
        self.assertEqual(document["objects"][0]["objectId"], "flat")

    def test_errors_name_the_file_and_the_next_step(self):
        self.expect_failure("name one in BigBIRD's layout")
        write_object(self.source, "flat", 90)
        self.expect_failure("has no object mug; give folders with a calibration.h5", "--objects", "mug")
        self.expect_failure("choose other cameras", "--cameras", "NP1")
        pose = os.path.join(self.source, "flat/poses/NP5_90_pose.h5")
        for wrong, text in ((2 * numpy.eye(4), "no rigid transform"), (numpy.diag((1, 1, -1, 1)), "no rigid transform"),
                            (numpy.eye(3), "it must be 4 x 4"), (numpy.full((4, 4), numpy.nan), "is not finite")):
            write_h5(pose, H_table_from_reference_camera=wrong)
            self.expect_failure(text)
        with open(pose, "w", encoding="ascii") as file:
            file.write("text")
        self.expect_failure("NP5_90_pose.h5 is no HDF5 file")
        os.remove(pose)
        self.expect_failure("NP5_90_pose.h5 is not there")

    def test_clouds_and_meshes_in_another_frame_are_errors(self):
        write_object(self.source, "flat", 90)
        self.expect_failure("teach at larger steps", "--teach-step-deg", "90")
        cloud = os.path.join(self.source, "flat/clouds/NP3_180.pcd")
        points = pcd_points(cloud)
        write_pcd(cloud, 1000 * points)
        self.expect_failure("NP3_180.pcd lies", "--teach-step-deg", "180")
        with open(cloud, "rb+") as file:
            file.truncate(os.path.getsize(cloud) // 2)
        self.expect_failure("NP3_180.pcd is no PCD file, or cut short", "--teach-step-deg", "180")
        write_pcd(cloud, points)
        mesh = os.path.join(self.source, "flat/textured_meshes/optimized_poisson_textured_mesh.ply")
        write_mesh(mesh, SIZES["flat"], numpy.eye(4), lift=0.3)
        self.expect_failure("transform it to the frame of the turntable", "--teach-step-deg", "180")


unittest.main(verbosity=2)
