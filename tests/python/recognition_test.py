"""Recognition, teaching, outcomes, changes and backups, with a server."""
import io
import os
import unittest

import matplotlib
import numpy as np

import graspdb
import scenes
from graspdb import errors, geometry
from graspdb.v1 import catalog_pb2, catalog_service_pb2, geometry_pb2, recognition_pb2
from server import Folder, Server

matplotlib.use("Agg")
from matplotlib import image as matplotlib_image  # noqa: E402

UPRIGHT = "objects/bracket/stablePoses/upright"


class Recognition(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(Folder())
        os.mkdir(cls.folder.path("backups"))
        cls.server = cls.enterClassContext(Server(cls.folder, "--backup-dir", cls.folder.path("backups")))
        cls.client = cls.enterClassContext(graspdb.Client(cls.server.address))
        cls.client.create_object("bracket", display_name="A bracket", labels=["steel"])
        tcp_pose = np.array([[1, 0, 0, 0.02], [0, -1, 0, 0], [0, 0, -1, 0.02], [0, 0, 0, 1]])
        cls.client.create_stable_pose("objects/bracket", "upright", grasps=[
            graspdb.Grasp("top", tcp_pose, approach_distance_m=0.1, gripper_opening_m=0.04, retreat_distance_m=0.05)])
        cls.taught = cls.client.teach(scenes.views(UPRIGHT, scenes.BRACKET))

    def recognize(self, image, **arguments):
        return self.client.recognize(depth=image, intrinsics=scenes.CAMERA, sensor_pose=scenes.sensor_pose(),
                                     **arguments)

    def assert_bracket(self, result, pose):
        self.assertIs(result.status, graspdb.Status.OK)
        (detection,) = result.detections
        self.assertEqual((detection.object, detection.stable_pose), ("objects/bracket", UPRIGHT))
        np.testing.assert_allclose(detection.pose[:3, 3], pose[:3, 3], atol=0.003)
        np.testing.assert_allclose(detection.pose[:3, :3], pose[:3, :3], atol=0.05)
        return detection

    def test_finds_a_taught_object_in_a_depth_image(self):
        pose = scenes.pose(0.03, -0.02, 40)
        result = self.recognize(scenes.depth(scenes.BRACKET, pose))
        detection = self.assert_bracket(result, pose)
        self.assertGreater(detection.score, 0.5)
        self.assertIs(result.world_frame_source, graspdb.WorldFrameSource.REQUEST)
        np.testing.assert_allclose(result.sensor_pose, scenes.sensor_pose(), atol=1e-9)
        (grasp,) = detection.grasps
        self.assertEqual((grasp.grasp_id, grasp.approach_distance_m, grasp.retreat_distance_m), ("top", 0.1, 0.05))
        np.testing.assert_allclose(grasp.tcp_pose, detection.pose @ [[1, 0, 0, 0.02], [0, -1, 0, 0], [0, 0, -1, 0.02],
                                                                     [0, 0, 0, 1]], atol=1e-6)
        self.assertEqual(detection.message.grasps[0].grasp.gripper_opening_m, 0.04)
        with self.assertRaises(ValueError):
            detection.pose[0, 3] = 1  # read-only

    def test_reads_the_grasps_of_earlier_servers(self):
        message = recognition_pb2.GraspProposal(grasp_id="top", approach_distance_m=0.1, gripper_opening_m=0.04, priority=2,
                                                retreat_distance_m=0.05)
        message.tcp_pose.orientation.w = 1
        for has_grasp in (False, True):
            if has_grasp:
                message.grasp.CopyFrom(catalog_pb2.Grasp(grasp_id="side", priority=3))
            grasp = graspdb.GraspProposal.of(message)
            self.assertEqual((grasp.grasp_id, grasp.approach_distance_m, grasp.gripper_opening_m, grasp.priority,
                              grasp.retreat_distance_m), ("side", 0, 0, 3, 0) if has_grasp else ("top", 0.1, 0.04, 2, 0.05))

    def test_finds_it_in_a_cloud_without_a_sensor_pose(self):
        cloud = scenes.points(scenes.depth(scenes.BRACKET, scenes.pose(yaw_deg=70)))
        for points in (cloud, cloud.reshape(-1, 3), cloud.astype(np.float32).tolist()):
            result = self.client.recognize(points)
            self.assertIs(result.status, graspdb.Status.OK)
            self.assertIs(result.world_frame_source, graspdb.WorldFrameSource.DOMINANT_PLANE)
            self.assertEqual(result.detections[0].object, "objects/bracket")

    def test_finds_it_in_an_image_of_metres(self):
        pose = scenes.pose(-0.05, 0.04, 200)
        metres = scenes.depth(scenes.BRACKET, pose) / 1000
        metres[metres == 0] = np.nan
        matrix = [[scenes.CAMERA.fx, 0, scenes.CAMERA.cx], [0, scenes.CAMERA.fy, scenes.CAMERA.cy], [0, 0, 1]]
        self.assert_bracket(self.client.recognize(depth=metres, intrinsics=matrix, sensor_pose=scenes.sensor_pose()),
                            pose)

    def test_finds_it_in_a_file_with_its_viewpoint(self):
        pose = scenes.pose(0.02, 0.03, 300)
        points = scenes.points(scenes.depth(scenes.BRACKET, pose)).astype("<f4")
        w = np.sqrt(1 + np.trace(scenes.sensor_pose()[:3, :3])) / 2
        x = (scenes.sensor_pose()[2, 1] - scenes.sensor_pose()[1, 2]) / (4 * w)
        path = self.folder.path("scan.pcd")
        with open(path, "wb") as file:
            file.write(b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 320\nHEIGHT 240\n"
                       + f"VIEWPOINT 0 -0.45 0.54 {w} {x} 0 0\nPOINTS 76800\nDATA binary\n".encode() + points.tobytes())
        result = self.client.recognize(path)
        self.assert_bracket(result, pose)
        self.assertIs(result.world_frame_source, graspdb.WorldFrameSource.REQUEST)

    def test_an_object_that_was_not_taught_is_unknown(self):
        result = self.recognize(scenes.depth(scenes.TOWER, scenes.pose(yaw_deg=20)))
        self.assertIs(result.status, graspdb.Status.UNKNOWN_OBJECT)
        (detection,) = result.detections
        self.assertIs(detection.status, graspdb.Status.UNKNOWN_OBJECT)
        self.assertIsNot(detection.rejected_by, graspdb.RejectionGate.UNSPECIFIED)
        self.assertIsNone(detection.pose)
        self.assertEqual((detection.object, detection.grasps, detection.equivalent_poses.shape), ("", (), (0, 4, 4)))
        np.testing.assert_allclose(detection.centroid[:2], 0, atol=0.03)

    def test_an_empty_table_has_a_status(self):
        image = scenes.depth(None, scenes.pose())
        self.assertIs(self.recognize(image).status, graspdb.Status.NO_CLUSTER)
        region = [[1, 1, 0], [1.1, 1.1, 0.1]]
        self.assertIs(self.recognize(image, region=region).status, graspdb.Status.EMPTY_REGION)

    def test_the_same_scan_gives_the_same_bytes(self):
        image = scenes.depth(scenes.BRACKET, scenes.pose(yaw_deg=10))
        first, second = (self.recognize(image, omit_timings=True).message.SerializeToString(deterministic=True)
                         for _ in range(2))
        self.assertEqual(first, second)

    def test_a_stored_view_is_recognised_as_it_is(self):
        views = self.client.catalog.ListViews(catalog_service_pb2.ListViewsRequest(parent=UPRIGHT)).views
        view = self.client.catalog.GetView(catalog_service_pb2.GetViewRequest(
            name=views[0].name, detail=catalog_pb2.VIEW_DETAIL_FULL))
        result = self.client.recognize(view.cloud, segmented=True, sensor_pose=geometry.matrix_of_pose(view.sensor_pose))
        self.assertEqual(result.detections[0].object, "objects/bracket")
        self.assertEqual(result.points.shape, (view.point_count, 3))

    def test_views_are_taught_once(self):
        self.assertEqual((self.taught.created_count, self.taught.existing_count), (12, 0))
        again = self.client.teach(scenes.views(UPRIGHT, scenes.BRACKET)[:3])
        self.assertEqual((again.created_count, again.existing_count), (0, 3))

    def test_objects_are_created_once(self):
        with self.assertRaises(errors.AlreadyExists):
            self.client.create_object("bracket")
        self.client.create_object("bracket", exist_ok=True)
        with self.assertRaises(errors.AlreadyExists):
            self.client.create_stable_pose("objects/bracket", "upright")
        self.client.create_stable_pose("objects/bracket", "upright", exist_ok=True)

    def test_outcomes_are_counted(self):
        before = self.client.report_outcome(UPRIGHT, "top", graspdb.Outcome.MISSED)
        request_id = "3f8f2d1c-6f0e-4a58-9d3b-0c5b6a1f7e11"
        for _ in range(2):  # sent again, counted once
            counts = self.client.report_outcome(UPRIGHT, "top", graspdb.Outcome.PICKED, count=3, request_id=request_id)
        self.assertEqual((counts.picked_count - before.picked_count, counts.missed_count), (3, before.missed_count))
        with self.assertRaises(errors.AlreadyExists) as raised:
            self.client.report_outcome(UPRIGHT, "top", graspdb.Outcome.SLIPPED, request_id=request_id)
        self.assertIs(raised.exception.reason, graspdb.Reason.REQUEST_ID_REUSED)

    def test_changes_are_watched(self):
        status = self.client.status()
        name = self.client.create_object("watched")
        self.client.create_stable_pose(name, "flat")
        self.client.catalog.DeleteObject(catalog_service_pb2.DeleteObjectRequest(name=name, force=True))
        changes = self.client.watch(status.catalog_revision, status.catalog_id, include_records=True)
        seen = [resource for change, _ in zip(changes, range(3)) for resource in change.resources]
        changes.close()
        self.assertEqual([resource.name for resource in seen[:2]], [name, name + "/stablePoses/flat"])
        self.assertIs(seen[0].kind, graspdb.ChangeKind.WRITTEN)
        self.assertEqual(seen[0].record.name, name)
        self.assertIs(seen[-1].kind, graspdb.ChangeKind.DELETED)

    def test_a_watch_from_the_future_ends_with_an_error(self):
        with self.assertRaises(errors.OutOfRange):
            next(self.client.watch(10 ** 9))

    def test_a_watch_begins_with_a_heartbeat(self):
        change = next(self.client.watch())
        self.assertEqual((change.resources, change.time), ((), None))
        self.assertEqual(change.catalog_id, self.client.status().catalog_id)

    def test_backups_are_made_and_verified(self):
        reports = []
        backup = self.client.create_backup(progress=lambda done, total: reports.append((done, total)))
        self.assertGreater(backup.view_count, 0)
        self.assertEqual(self.client.verify_backup(backup.name).name, backup.name)
        done, total = reports[-1]
        self.assertGreater(done, 0)
        self.assertEqual(([each for _, each in reports[:-1]], total), ([0] * (len(reports) - 1), done))
        with self.assertRaises(errors.NotFound):
            self.client.verify_backup("backups/77")

    def test_a_drawing_shows_the_object(self):
        pose = scenes.pose(yaw_deg=40)
        image = scenes.depth(scenes.BRACKET, pose)
        for result in (self.recognize(image), self.client.recognize(scenes.points(image).reshape(-1, 3))):
            axes = result.draw()
            self.assertTrue([text for text in axes.texts if text.get_text().startswith("bracket 0.")])
            file = io.BytesIO()
            axes.figure.savefig(file, format="png")
            matplotlib.pyplot.close(axes.figure)
            file.seek(0)
            pixels = matplotlib_image.imread(file)[..., :3]
            for channel in range(3):  # red, green and blue axes of the object
                others = np.delete(pixels, channel, axis=2)
                self.assertGreater(((pixels[..., channel] > 0.45) & (others < 0.1).all(axis=2)).sum(), 20)
            self.assertGreater((pixels < 0.5).all(axis=2).mean(), 0.2)  # the scan, dark where the table is

    def test_a_drawing_shows_what_is_unknown(self):
        axes = self.recognize(scenes.depth(scenes.TOWER, scenes.pose(yaw_deg=20))).draw()
        self.assertEqual([text.get_text() for text in axes.texts], ["unknown"])
        matplotlib.pyplot.close(axes.figure)


class Errors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(Folder())
        server = cls.enterClassContext(Server(folder))
        cls.client = cls.enterClassContext(graspdb.Client(server.address))

    def test_the_stubs_raise_them_too(self):
        with self.assertRaises(errors.NotFound) as raised:
            self.client.catalog.GetObject(catalog_service_pb2.GetObjectRequest(name="objects/none"))
        self.assertIs(raised.exception.reason, graspdb.Reason.NOT_FOUND)
        self.assertEqual(raised.exception.code.name, "NOT_FOUND")
        self.assertIn("objects/none", str(raised.exception))
        self.assertTrue(raised.exception.request_id)
        self.assertIsNone(raised.exception.retry_delay_s)

    def test_they_name_the_field(self):
        with self.assertRaises(errors.InvalidArgument) as raised:
            self.client.recognize(np.full((100, 3), 0.5), region=[[0, 0, 0], [-1, 1, 1]])
        self.assertIn("region_of_interest", raised.exception.fields[0][0])
        self.assertIsInstance(raised.exception, ValueError)

    def test_millimetres_get_advice(self):
        millimetres = scenes.points(scenes.depth(scenes.BRACKET, scenes.pose())) * 1000
        with self.assertRaisesRegex(errors.InvalidArgument, "metre"):
            self.client.recognize(millimetres)

    def test_a_capture_without_an_object_has_its_reason(self):
        self.client.create_object("box")
        stable_pose = self.client.create_stable_pose("objects/box", "flat")
        with self.assertRaises(errors.FailedPrecondition) as raised:
            self.client.teach(scenes.views(stable_pose, None, 180))
        self.assertIs(raised.exception.reason, graspdb.Reason.NO_CLUSTER)

    def test_arguments_that_cannot_be_sent(self):
        image = scenes.depth(None, scenes.pose())
        scaled = np.diag([2.0, 2, 2, 1])
        mirrored = np.diag([1.0, 1, -1, 1])
        for arguments, advice in (
                ({}, "either a cloud or a depth image"),
                ({"cloud": np.zeros((4, 2))}, "N × 3"),
                ({"cloud": [["a", "b", "c"]]}, "N × 3"),
                ({"depth": image}, "intrinsics"),
                ({"depth": image.astype(np.int64), "intrinsics": scenes.CAMERA}, "uint16"),
                ({"depth": image[0], "intrinsics": scenes.CAMERA}, "H × W"),
                ({"cloud": np.ones((9, 3)), "sensor_pose": np.eye(3)}, "sensor_pose is no pose"),
                ({"cloud": np.ones((9, 3)), "sensor_pose": np.full((4, 4), np.nan)}, "sensor_pose is no pose"),
                ({"cloud": np.ones((9, 3)), "sensor_pose": scaled}, "rigid"),
                ({"cloud": np.ones((9, 3)), "sensor_pose": mirrored}, "rigid"),
                ({"cloud": np.ones((9, 3)), "region": [0, 0, 0, 1, 1, 1]}, "2 × 3")):
            with self.assertRaisesRegex(ValueError, advice):
                self.client.recognize(**arguments)
        with self.assertRaisesRegex(ValueError, "list"):
            self.client.create_object("part", labels="steel")

    def test_reasons_and_codes_are_those_of_the_documentation(self):
        with open(os.path.join(os.environ["GRASPDB"], "docs/errors.md"), encoding="utf-8") as file:
            codes, reasons, statuses, gates = (
                {line.split("`")[1] for line in section.splitlines() if line.startswith("| `")}
                for section in file.read().split("\n## ")[1:5])
        self.assertEqual({reason.name for reason in graspdb.Reason} - {"OTHER"}, codes | reasons)
        self.assertEqual({status.name for status in graspdb.Status} - {"UNSPECIFIED"}, statuses)
        self.assertEqual({"REJECTION_GATE_" + gate.name for gate in graspdb.RejectionGate if gate}, gates)

    def test_enums_are_those_of_the_contract(self):
        from graspdb.v1 import change_service_pb2, recognition_pb2
        for ours, theirs, prefix in (
                (graspdb.Status, recognition_pb2.RecognitionStatus, ""),
                (graspdb.RejectionGate, recognition_pb2.RejectionGate, "REJECTION_GATE_"),
                (graspdb.WorldFrameSource, recognition_pb2.WorldFrameSource, "WORLD_FRAME_SOURCE_"),
                (graspdb.ChangeKind, change_service_pb2.ChangeKind, "CHANGE_KIND_"),
                (graspdb.Outcome, catalog_pb2.GraspOutcome, "GRASP_OUTCOME_")):
            self.assertEqual({prefix + each.name: each.value for each in ours if each},
                             {name: value for name, value in theirs.items() if value})
        self.assertIs(graspdb.Status(99), graspdb.Status.UNSPECIFIED)  # of a newer server
        self.assertIs(graspdb.Reason("NEWER"), graspdb.Reason.OTHER)


class Poses(unittest.TestCase):
    def test_matrices_and_messages_are_the_same_poses(self):
        random = np.random.default_rng(7)
        turns = [np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(50)]
        turns = [turn * np.linalg.det(turn) for turn in turns] + [np.diag([1.0, -1, -1]), np.diag([-1.0, -1, 1]), np.eye(3)]
        for turn in turns:
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = turn, random.normal(size=3)
            message = geometry.pose_of_matrix(matrix, "pose")
            q = message.orientation
            self.assertAlmostEqual(q.x ** 2 + q.y ** 2 + q.z ** 2 + q.w ** 2, 1)
            np.testing.assert_allclose(geometry.matrix_of_pose(message), matrix, atol=1e-12)

    def test_a_quarter_about_z(self):
        message = geometry.pose_of_matrix(scenes.pose(1, 2, 90), "pose")
        half = np.sqrt(0.5)
        np.testing.assert_allclose([message.orientation.z, message.orientation.w], [half, half], atol=1e-12)
        self.assertEqual(message.position, geometry_pb2.Vector3(x=1, y=2, z=0))


if __name__ == "__main__":
    unittest.main()
