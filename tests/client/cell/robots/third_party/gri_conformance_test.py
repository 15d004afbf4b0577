"""Tests all actions of the Generic Robot Interface against a server in another process.

Usage: gri_conformance_test.py SERVER_PROGRAM, a program that prints "gri PORT" and serves the jobs
below until its standard input ends (tests/client/cell/robots/scripted_server.cc).
"""

import math
import random
import struct
import subprocess
import sys
import unittest

import gri_client as gri

ECHO, TWO_GRASPS, NOTHING, SLOW, GO_ON, FAR = 1, 2, 3, 4, 5, 6
# Jobs that always end in this code.
FAILING = {11: "UNKNOWN_ERROR", 12: "INTERNAL_ERROR", 13: "API_NOT_REACHABLE",
           14: "API_RESPONSE_ERROR", 15: "INVALID_REQUEST_ERROR", 16: "PROCESSING_TIMEOUT",
           17: "WRONG_PROTOCOL_FOR_JOB", 18: "MISCONFIGURED_JOB", 19: "PIPELINE_NOT_AVAILABLE",
           20: "NO_RETURN_SPECIFIED"}


class GriConformanceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = subprocess.Popen([PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      text=True)
        name, port = cls.server.stdout.readline().split()
        assert name == "gri"
        cls.port = int(port)

    @classmethod
    def tearDownClass(cls):
        cls.server.stdin.close()
        cls.server.stdout.close()
        assert cls.server.wait(30) == 0

    def setUp(self):
        self.robot = gri.GriClient(self.port)
        self.addCleanup(self.robot.socket.close)

    def is_serving(self):
        with gri.GriClient(self.port) as other:
            return other.call(gri.STATUS).data[2] == 1

    def assert_same_rotation(self, one, other, why):
        worst = max(abs(a - b) for x, y in zip(one, other) for a, b in zip(x, y))
        self.assertLess(worst, 1e-5, why)

    def test_status(self):
        answer = self.robot.call(gri.STATUS)
        self.assertEqual((answer.code, answer.action, answer.data[2]), ("NO_ERROR", gri.STATUS, 1))

    def test_primary_and_related_poses_come_one_after_the_other(self):
        first = self.robot.call(gri.TRIGGER_JOB_SYNC, TWO_GRASPS)
        self.assertEqual((first.code, first.job_id), ("NO_ERROR", TWO_GRASPS))
        self.assertEqual(first.pose.position, (100, 200, -300))
        self.assertEqual(first.data[2:4], (1, 1))
        related = self.robot.call(gri.GET_RELATED_POSE, TWO_GRASPS)
        self.assertEqual((related.code, related.pose.position[0]), ("NO_ERROR", 110))
        self.assertEqual(related.data[2:4], (1, 0))
        self.assertEqual(self.robot.call(gri.GET_RELATED_POSE, TWO_GRASPS).code, "NO_RELATED_POSES")
        second = self.robot.call(gri.GET_NEXT_POSE, TWO_GRASPS)
        self.assertEqual((second.pose.position[0], second.data[2:4]), (200, (0, 0)))
        self.assertEqual(self.robot.call(gri.GET_JOB_STATUS, TWO_GRASPS).data[2], gri.DONE)
        self.assertEqual(self.robot.call(gri.GET_NEXT_POSE, TWO_GRASPS).code, "NO_POSES_FOUND")
        self.assertEqual(self.robot.call(gri.GET_JOB_STATUS, TWO_GRASPS).data[2], gri.INACTIVE)

    def test_an_asynchronous_job_reports_that_it_runs(self):
        self.assertEqual(self.robot.call(gri.TRIGGER_JOB_ASYNC, SLOW).code, "NO_ERROR")
        self.assertEqual(self.robot.call(gri.GET_JOB_STATUS, SLOW).data[2], gri.RUNNING)
        for action in (gri.TRIGGER_JOB_SYNC, gri.TRIGGER_JOB_ASYNC, gri.GET_NEXT_POSE,
                       gri.GET_RELATED_POSE):
            self.assertEqual(self.robot.call(action, SLOW).code, "JOB_STILL_RUNNING")
        self.robot.call(gri.TRIGGER_JOB_SYNC, GO_ON)
        while self.robot.call(gri.GET_JOB_STATUS, SLOW).data[2] == gri.RUNNING:
            pass
        self.assertEqual(self.robot.call(gri.GET_NEXT_POSE, SLOW).code, "NO_ERROR")

    def test_every_error_has_its_code(self):
        for job, code in FAILING.items():
            self.assertEqual(self.robot.call(gri.TRIGGER_JOB_SYNC, job).code, code)
        self.assertEqual(self.robot.call(gri.GET_JOB_STATUS, 13).data[2], gri.FAILED)
        self.assertEqual(self.robot.call(gri.TRIGGER_JOB_SYNC, NOTHING).code, "NO_POSES_FOUND")
        for action in range(gri.TRIGGER_JOB_SYNC, gri.HEC_INIT):
            self.assertEqual(self.robot.call(action, 99).code, "JOB_DOES_NOT_EXIST")

    def test_calibration_without_pipelines_is_rejected(self):
        for action in (gri.HEC_INIT, gri.HEC_SET_POSE, gri.HEC_CALIBRATE):
            self.assertEqual(self.robot.call(action, ECHO).code, "PIPELINE_NOT_AVAILABLE")

    def test_header_errors_keep_the_connection(self):
        for fault, code in (({"version": 2}, "UNKNOWN_PROTOCOL_VERSION"),
                            ({"pose_format": 0}, "INVALID_REQUEST_ERROR"),
                            ({"pose_format": 52}, "INVALID_REQUEST_ERROR")):
            self.assertEqual(self.robot.call(gri.STATUS, **fault).code, code)
        for action in (0, 10, 255):
            self.assertEqual(self.robot.call(action, ECHO).code, "INVALID_ACTION")
        self.assertEqual(self.robot.call(gri.STATUS).code, "NO_ERROR")

    def test_a_wrong_length_closes_the_connection(self):
        self.assertEqual(self.robot.call(gri.STATUS, length=80).code, "INVALID_REQUEST_LENGTH")
        self.assertRaises(gri.Closed, self.robot.receive)
        self.assertTrue(self.is_serving())

    def test_all_formats_match_the_documentation(self):
        # The server's pose of TWO_GRASPS: 30 degrees about Z, then 20 about Y, then 10 about X.
        angles = [math.radians(degrees) for degrees in (30, 20, 10)]
        truth = gri.product(gri.product(gri.turn("Z", angles[0]), gri.turn("Y", angles[1])),
                            gri.turn("X", angles[2]))
        for pose_format in range(1, 52):
            answer = self.robot.call(gri.TRIGGER_JOB_SYNC, TWO_GRASPS, pose_format=pose_format)
            self.assertEqual(answer.pose_format, pose_format)
            self.assert_same_rotation(gri.rotation_of(answer.pose.rotation, pose_format), truth,
                                      f"format {pose_format}")
        kuka = self.robot.call(gri.TRIGGER_JOB_SYNC, TWO_GRASPS, pose_format=24).pose.rotation
        self.assertEqual(kuka, (30, 20, 10, 0))
        fanuc = self.robot.call(gri.TRIGGER_JOB_SYNC, TWO_GRASPS, pose_format=26).pose.rotation
        self.assertEqual(fanuc, (10, 20, 30, 0))

    def test_the_robots_own_pose_is_parsed_in_all_formats(self):
        chance = random.Random(1)
        for pose_format in range(1, 52):
            numbers = [chance.uniform(-1.5, 1.5) for _ in range(3)]
            if pose_format <= 2:
                numbers = [chance.gauss(0, 1) for _ in range(4)]
                length = math.hypot(*numbers)
                numbers = [number / length for number in numbers]
            sent = gri.Pose((1000.25, -2000.5, 0.000001), tuple(numbers))
            back = self.robot.call(gri.TRIGGER_JOB_SYNC, ECHO, pose=sent, pose_format=pose_format)
            self.assertEqual(back.code, "NO_ERROR")
            self.assertEqual(back.pose.position, sent.position)
            self.assert_same_rotation(gri.rotation_of(back.pose.rotation, pose_format),
                                      gri.rotation_of(numbers, pose_format), pose_format)

    def test_an_out_of_range_pose_is_an_error(self):
        answer = self.robot.call(gri.TRIGGER_JOB_SYNC, FAR)
        self.assertEqual((answer.code, answer.pose.position), ("API_RESPONSE_ERROR", (0, 0, 0)))

    def test_garbage_and_partial_messages_are_tolerated(self):
        chance = random.Random(2)
        for _ in range(50):
            with gri.GriClient(self.port) as robot:
                robot.send(b"x" + chance.randbytes(chance.randrange(5000)))
                self.assertEqual(robot.receive().code, "INVALID_REQUEST_ERROR")
                self.assertRaises(gri.Closed, robot.receive)
        for length in range(1, gri.REQUEST.size):
            with gri.GriClient(self.port) as robot:
                robot.send(gri.request_bytes(gri.STATUS)[:length])
        # Right headers, and anything behind them.
        for _ in range(200):
            head = struct.pack("<4sBBBB", gri.MAGIC, 1, 54, chance.randrange(1, 52),
                               chance.choice((1, 2, 4, 5, 6)))
            self.robot.send(head + struct.pack("<H", ECHO) + chance.randbytes(44))
            self.assertIn(self.robot.receive().code,
                          ("NO_ERROR", "NO_POSES_FOUND", "NO_RELATED_POSES", "API_RESPONSE_ERROR",
                           "INVALID_REQUEST_ERROR"))
        self.assertTrue(self.is_serving())

    def test_a_hundred_connections_at_once(self):
        robots = [gri.GriClient(self.port) for _ in range(100)]
        for step in range(3):
            for place, robot in enumerate(robots):
                pose = gri.Pose((place, step, 0), (0, 0, 0, 1))
                robot.send(gri.request_bytes(gri.STATUS, pose=pose))
            for robot in robots:
                self.assertEqual(robot.receive().data[2], 1)
        for robot in robots:
            robot.socket.close()

    def test_two_robots_do_not_take_each_others_poses(self):
        with gri.GriClient(self.port, "127.0.0.2") as left, \
                gri.GriClient(self.port, "127.0.0.3") as right:
            for robot in (left, right):
                self.assertEqual(robot.call(gri.TRIGGER_JOB_SYNC, TWO_GRASPS).data[2], 1)
            for robot in (left, right):
                self.assertEqual(robot.call(gri.GET_NEXT_POSE, TWO_GRASPS).pose.position[0], 200)

    def test_poses_survive_reconnects(self):
        def call_once(action):
            with gri.GriClient(self.port, "127.0.0.4") as robot:
                return robot.call(action, TWO_GRASPS)
        call_once(gri.TRIGGER_JOB_SYNC)
        self.assertEqual(call_once(gri.GET_RELATED_POSE).pose.position[0], 110)
        self.assertEqual(call_once(gri.GET_NEXT_POSE).pose.position[0], 200)

    def test_many_requests_in_one_packet_are_answered_in_order(self):
        self.robot.send(b"".join(
            gri.request_bytes(gri.TRIGGER_JOB_SYNC, ECHO, pose=gri.Pose((x, 0, 0), (0, 0, 0, 1)))
            for x in range(50)))
        self.assertEqual([self.robot.receive().pose.position[0] for _ in range(50)],
                         list(range(50)))


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
