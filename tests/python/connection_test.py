"""Connections: TLS, tokens, retries, and uploads over connections that break."""
import concurrent.futures
import contextlib
import io
import os
import subprocess
import time
import unittest
from unittest import mock

import grpc
import numpy as np
from google.protobuf import duration_pb2

import graspdb
import scenes
from graspdb import _channel, errors
from graspdb._rpc import error_details_pb2, status_pb2
from graspdb.v1 import catalog_pb2, catalog_service_pb2, catalog_service_pb2_grpc, upload_service_pb2
from server import BIN, Folder, Relay, Server

STATUS = catalog_service_pb2.GetCatalogStatusRequest()


def certificate(folder, name, alternative_name, authority="plant"):
    """NAME.pem and NAME.key in the folder, as in docs/security.md."""
    new = ["openssl", "req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", name + ".key",
           "-subj", "/CN=" + name]
    if name == authority:
        commands = [[*new, "-x509", "-out", name + ".pem", "-days", "3650"]]
    else:
        with open(folder.path(name + ".ext"), "w", encoding="ascii") as file:
            file.write("subjectAltName=" + alternative_name)
        commands = [[*new, "-out", name + ".csr"],
                    ["openssl", "x509", "-req", "-in", name + ".csr", "-CA", authority + ".pem", "-CAkey",
                     authority + ".key", "-CAcreateserial", "-days", "365", "-out", name + ".pem", "-extfile",
                     name + ".ext"]]
    for command in commands:
        subprocess.run(command, cwd=folder.name, check=True, capture_output=True)


class Security(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = folder = cls.enterClassContext(Folder())
        certificate(folder, "plant", "")
        certificate(folder, "server", "DNS:localhost,IP:127.0.0.1")
        certificate(folder, "engineer", "URI:spiffe://plant/engineer")
        certificate(folder, "other", "", "other")
        identity = subprocess.run(
            [os.path.join(BIN, "graspdb-server"), "token", "cell", "--role", "read", "--out", "cell.token"],
            cwd=folder.name, check=True, capture_output=True, text=True).stdout
        with open(folder.path("identities.jsonl"), "w", encoding="utf-8") as file:
            file.write(identity + '{"name":"engineer","roles":["ROLE_ADMIN"],'
                       '"certificates":["uri:spiffe://plant/engineer"]}\n')
        flags = ("--tls-cert", "server.pem", "--tls-key", "server.key", "--tls-client-ca", "plant.pem",
                 "--identities", "identities.jsonl")
        cls.server = cls.enterClassContext(
            Server(folder, *(folder.path(flag) if "." in flag else flag for flag in flags)))

    def client(self, **arguments):
        return self.enterContext(graspdb.Client(self.server.address, **arguments))

    def path(self, name):
        return self.folder.path(name)

    def test_a_certificate_is_an_identity(self):
        client = self.client(ca=self.path("plant.pem"), cert=self.path("engineer.pem"), key=self.path("engineer.key"))
        self.assertEqual(client.create_object("box"), "objects/box")

    def test_a_token_is_an_identity_with_its_roles(self):
        with open(self.path("cell.token"), encoding="ascii") as file:
            token = file.read().strip()
        for arguments in ({"token": token}, {"token_file": self.path("cell.token")}):
            client = self.client(ca=self.path("plant.pem"), **arguments)
            self.assertEqual(client.status().server_version, self.client(
                ca=self.path("plant.pem"), cert=self.path("engineer.pem"),
                key=self.path("engineer.key")).status().server_version)
            next(client.watch())  # streams have it too
            with self.assertRaisesRegex(errors.PermissionDenied, "teach"):
                client.create_object("none")
            with self.assertRaises(errors.PermissionDenied):
                client.teach([])

    def test_a_caller_without_identity_is_refused(self):
        for arguments in ({}, {"token": "wrong"}):
            with self.assertRaises(errors.Unauthenticated) as raised:
                self.client(ca=self.path("plant.pem"), **arguments).status()
            self.assertIs(raised.exception.reason, graspdb.Reason.UNAUTHENTICATED)

    def test_wrong_connections_get_advice(self):
        for arguments, advice in (({"ca": self.path("other.pem")}, "not signed by an authority of ca "),
                                  ({}, "give ca if it uses TLS")):
            with self.assertRaisesRegex(errors.Unavailable, advice):
                self.client(retry=False, **arguments).status()
        with self.enterContext(Folder()) as folder, Server(folder) as plain:
            with self.assertRaisesRegex(errors.Unavailable, "does not use TLS"):
                self.enterContext(graspdb.Client(plain.address, ca=self.path("plant.pem"), retry=False)).status()

    def test_settings_that_no_connection_can_have(self):
        for server, arguments, advice in (
                ("localhost", {}, "HOST:PORT"), ("", {}, "HOST:PORT"), ("::1:50051", {}, "HOST:PORT"),
                ("localhost:0", {}, "HOST:PORT"), ("localhost:65536", {}, "HOST:PORT"),
                ("localhost:50051", {"cert": "a.pem"}, "belong together"),
                ("localhost:50051", {"token": "a", "token_file": "b"}, "exclude"),
                ("localhost:50051", {"token": "a b"}, "no token"), ("localhost:50051", {"token": ""}, "no token"),
                ("plant.example:50051", {"token": "a"}, "without encryption"),
                ("127.0.0.1.example:50051", {"token": "a"}, "without encryption")):
            with self.assertRaisesRegex(ValueError, advice):
                graspdb.Client(server, **arguments)
        with self.assertRaises(FileNotFoundError):
            graspdb.Client(ca="missing.pem")
        for server in ("[::1]:50051", "unix:/tmp/socket", "dns:///localhost:50051"):
            graspdb.Client(server).close()


class BusyServer(catalog_service_pb2_grpc.CatalogServiceServicer):
    """Refuses calls as the list of errors says, one for each call, and then accepts."""

    def __init__(self):
        self.refusals = []
        self.calls = []

    def answer(self, name, context, response):
        self.calls.append(name)
        if self.refusals:
            code, details = self.refusals.pop(0)
            status = status_pb2.Status(code=code.value[0], message="refused")
            for detail in details:
                status.details.add().Pack(detail)
            context.set_trailing_metadata([("grpc-status-details-bin", status.SerializeToString())])
            context.abort(code, "refused")
        return response

    def GetCatalogStatus(self, request, context):  # noqa: N802
        return self.answer("status", context, catalog_service_pb2.CatalogStatus(catalog_revision=7))

    def CreateObject(self, request, context):  # noqa: N802
        return self.answer("create", context, catalog_pb2.Object())

    def ReportGraspOutcome(self, request, context):  # noqa: N802
        return self.answer(request.request_id, context, catalog_service_pb2.ReportGraspOutcomeResponse())


def busy(delay_s=0.001):
    delay = duration_pb2.Duration()
    delay.FromNanoseconds(int(delay_s * 1e9))
    return (grpc.StatusCode.RESOURCE_EXHAUSTED, [
        error_details_pb2.ErrorInfo(reason="QUEUE_FULL", domain="graspdb"),
        error_details_pb2.RetryInfo(retry_delay=delay)])


FULL = (grpc.StatusCode.RESOURCE_EXHAUSTED, [error_details_pb2.ErrorInfo(reason="RESOURCE_EXHAUSTED", domain="graspdb")])
LOST = (grpc.StatusCode.UNAVAILABLE, [])


class Retries(unittest.TestCase):
    def setUp(self):
        self.service = BusyServer()
        server = grpc.server(concurrent.futures.ThreadPoolExecutor(2))
        catalog_service_pb2_grpc.add_CatalogServiceServicer_to_server(self.service, server)
        self.address = f"127.0.0.1:{server.add_insecure_port('127.0.0.1:0')}"
        server.start()
        self.addCleanup(lambda: server.stop(None).wait())
        # Random parts of pauses are as long as they can be, and take no time.
        self.pauses = []
        self.enterContext(mock.patch.object(_channel.time, "sleep", self.pauses.append))
        self.enterContext(mock.patch.object(_channel.random, "random", lambda: 1.0))

    def client(self, **arguments):
        return self.enterContext(graspdb.Client(self.address, **arguments))

    def test_every_call_is_sent_again_while_the_server_is_busy(self):
        self.service.refusals = [busy(), busy(0.25), busy(), busy(5)]
        self.client().create_object("box")
        self.assertEqual(self.service.calls, ["create"] * 5)
        np.testing.assert_allclose(self.pauses, [0.002, 0.252, 0.005, 5.008])  # the delay, and a span that doubles
        self.service.refusals = [busy(5)]
        self.client().status()
        self.assertEqual(self.pauses[-1], 6)  # of one second at most

    def test_the_pauses_grow_up_to_a_second_and_end(self):
        self.service.refusals = [busy(0.1)] * 9
        with self.assertRaises(errors.ResourceExhausted) as raised:
            self.client().status()
        self.assertEqual(len(self.service.calls), 8)
        np.testing.assert_allclose(self.pauses, [0.2, 0.3, 0.5, 0.9, 1.1, 1.1, 1.1])
        self.assertIs(raised.exception.reason, graspdb.Reason.QUEUE_FULL)
        self.assertAlmostEqual(raised.exception.retry_delay_s, 0.1)

    def test_what_is_full_is_not_sent_again(self):
        for refusal in (FULL, busy(60), busy(-1)):
            self.service.refusals = [refusal]
            with self.assertRaises(errors.ResourceExhausted):
                self.client().status()
        self.assertEqual((len(self.service.calls), self.pauses), (3, []))

    def test_no_pause_exceeds_the_time_limit(self):
        self.service.refusals = [busy(20)]
        with self.assertRaises(errors.ResourceExhausted):
            self.client(timeout_s=10).status()
        self.assertEqual(self.pauses, [])

    def test_only_repeatable_calls_are_sent_again_after_a_lost_connection(self):
        self.service.refusals = [LOST, LOST]
        self.assertEqual(self.client().status().catalog_revision, 7)
        self.assertEqual(self.service.calls, ["status"] * 3)
        self.service.refusals = [LOST]
        with self.assertRaises(errors.Unavailable):
            self.client().create_object("box")
        self.assertEqual(self.service.calls, ["status"] * 3 + ["create"])

    def test_a_report_keeps_its_request_id(self):
        self.service.refusals = [LOST, busy()]
        self.client().report_outcome("objects/a/stablePoses/b", "top", graspdb.Outcome.PICKED)
        first, second, third = self.service.calls
        self.assertEqual((first, second), (second, third))
        self.assertRegex(first, "^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-")

    def test_without_retries_there_is_one_attempt(self):
        for refusal in (LOST, busy()):
            self.service.refusals = [refusal]
            with self.assertRaises(errors.Error):
                self.client(retry=False).status()
        self.assertEqual(len(self.service.calls), 2)


class Uploads(unittest.TestCase):
    stable_pose = "objects/bracket/stablePoses/upright"

    @classmethod
    def setUpClass(cls):
        cls.views = scenes.views(cls.stable_pose, scenes.BRACKET, 15)

    def setUp(self):
        self.folder = self.enterContext(Folder())
        self.server = self.enterContext(Server(self.folder))
        self.relay = self.enterContext(Relay(self.server.address))
        self.client = self.enterContext(graspdb.Client(self.server.address))
        self.client.create_stable_pose(self.client.create_object("bracket"), "upright")

    def view_count(self):
        return self.client.status().view_count

    def test_all_views_are_in_the_catalogue_together(self):
        seen = []
        result = self.client.upload("brackets", self.views, progress=lambda *each: seen.append(each))
        self.assertEqual((result.created, result.existing, result.failed), (24, 0, ()))
        self.assertEqual(result.catalog_revision, self.client.status().catalog_revision)
        self.assertEqual(seen, [(k, 24) for k in range(1, 25)])
        again = self.client.upload("brackets", self.views)  # committed: another one of the same id
        self.assertEqual((again.created, again.existing, self.view_count()), (0, 24, 24))

    def test_the_bar_shows_how_many_are_done(self):
        with contextlib.redirect_stderr(io.StringIO()) as text:
            self.client.upload("brackets", self.views, progress=True)
        last = text.getvalue().rpartition("\r")[2]
        self.assertRegex(last, r"^\[#{30}\] 24/24 views, [0-9.]+/s\n$")

    def test_it_goes_on_after_a_lost_connection(self):
        client = self.enterContext(graspdb.Client(self.relay.address))
        cuts = []

        def progress(done, _):
            if done in (5, 17):
                cuts.append(done)
                self.relay.cut()

        result = client.upload("brackets", self.views, streams=1, progress=progress)
        self.assertEqual((cuts, result.created, self.view_count()), ([5, 17], 24, 24))

    def test_another_call_continues_where_the_server_was_lost(self):
        client = self.enterContext(graspdb.Client(self.relay.address, busy_retries=1))
        with self.assertRaisesRegex(errors.Unavailable, "the views sent are safe, upload again"):
            client.upload("brackets", self.views, streams=1,
                          progress=lambda done, _: done == 5 and self.relay.cut(for_good=True))
        staged = self.client.uploads.GetUpload(upload_service_pb2.GetUploadRequest(name="uploads/brackets"))
        self.assertGreaterEqual(staged.staged_view_count, 5)
        self.assertEqual(self.view_count(), 0)
        sent = []
        write_views = self.client.uploads.WriteUploadViews

        def write(requests):
            batch = list(requests)
            sent.extend(batch)
            return write_views(iter(batch))

        with mock.patch.object(self.client.uploads, "WriteUploadViews", write):
            result = self.client.upload("brackets", self.views)
        self.assertEqual((result.created, self.view_count()), (24, 24))
        self.assertLessEqual(len(sent), 24 - staged.staged_view_count)  # the others are not sent again

    def test_views_that_cannot_be_taught_keep_the_others_out_or_are_left_out(self):
        views = self.views[:3] + scenes.views(self.stable_pose, None, 180)[:1]
        with self.assertRaisesRegex(errors.UploadFailed, "1 of 4 views cannot be taught.*skip_failed=True") as raised:
            self.client.upload("brackets", views)
        ((name, error),) = raised.exception.failed
        self.assertIs(error.reason, graspdb.Reason.NO_CLUSTER)
        self.assertTrue(name.startswith(self.stable_pose + "/views/"))
        self.assertEqual(self.view_count(), 0)
        result = self.client.upload("brackets", views, skip_failed=True)
        self.assertEqual((result.created, [each for each, _ in result.failed], self.view_count()), (3, [name], 3))

    def test_a_file_that_cannot_be_read_ends_it(self):
        views = [*self.views[:2], graspdb.View(self.stable_pose, cloud=self.folder.path("none.pcd"))]
        with self.assertRaises(FileNotFoundError):
            self.client.upload("brackets", views)
        self.assertEqual(self.view_count(), 0)


class Restarts(unittest.TestCase):
    def status_after_restart(self, folder, server, flags, client):
        """Until it is connected again; the test's time limit is the end."""
        server.stop(kill=True)
        with self.assertRaisesRegex(errors.Unavailable, "no graspdb server is reachable at 127.0.0.1"):
            client.status()
        self.enterContext(Server(folder, *flags, port=int(server.address.rpartition(":")[2])))
        while True:
            try:
                return client.status()
            except errors.Unavailable:
                time.sleep(1)

    def test_calls_succeed_after_a_restart_of_the_server(self):
        folder = self.enterContext(Folder())
        server = Server(folder)
        client = self.enterContext(graspdb.Client(server.address))
        revision = client.status().catalog_revision
        self.assertEqual(self.status_after_restart(folder, server, (), client).catalog_revision, revision)

    def test_calls_without_retries_succeed_after_a_restart_with_tls(self):
        folder = self.enterContext(Folder())
        certificate(folder, "plant", "")
        certificate(folder, "server", "IP:127.0.0.1")
        flags = ("--tls-cert", folder.path("server.pem"), "--tls-key", folder.path("server.key"))
        server = Server(folder, *flags)
        client = self.enterContext(graspdb.Client(server.address, ca=folder.path("plant.pem"), retry=False))
        revision = client.status().catalog_revision
        self.assertEqual(self.status_after_restart(folder, server, flags, client).catalog_revision, revision)


if __name__ == "__main__":
    unittest.main()
