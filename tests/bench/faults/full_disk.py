"""full_disk.py BIN OUT SET ROUNDS: a server on a file system of 256 MB that has not a free byte, again and again.

In each round an object is taught, the disk is filled, a view and an object are deleted, the server is killed and started
again, a backup is made and restored on another disk, and views are taught again once there is room. After each step every
acknowledged view and deletion is compared with the catalogue, and in the restored one too. Prints a Markdown table.
Needs root (`unshare -m` around it keeps the mount to itself), the folder of the generated messages in PYTHONPATH, and that of
the fifth example.
"""
import collections
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import time

import grpc

import plant
from graspdb.v1 import catalog_pb2, catalog_service_pb2 as catalog, catalog_service_pb2_grpc

PAGE = b"x" * 4096
VIEWS = 12
counts = collections.Counter()
slowest = collections.Counter()


class Server:
    def __init__(self, program, database, backups):
        begin = time.monotonic()
        self.process = subprocess.Popen(
            [program, "--db", database, "--listen", "127.0.0.1:0", "--backup-dir", backups, "--log-level", "warn"],
            stdout=subprocess.PIPE, stderr=open(OUT + "/server.log", "ab"))
        line = b""
        while not line.startswith(b"listening on "):
            line = self.process.stdout.readline()
            if not line:
                sys.exit(f"the server does not start: see {OUT}/server.log")
        self.address = line.split()[-1].decode()
        slowest["start"] = max(slowest["start"], time.monotonic() - begin)
        self.channel = grpc.insecure_channel(self.address, options=[("grpc.use_local_subchannel_pool", 1)])
        self.stub = catalog_service_pb2_grpc.CatalogServiceStub(self.channel)

    def end(self, with_signal):
        self.channel.close()
        self.process.send_signal(with_signal)
        self.process.wait()


def digest(view):
    return hashlib.sha256(view.cloud.data).hexdigest()


class Round:
    def __init__(self, captures, clouds):
        self.captures, self.clouds = captures, clouds
        self.views = {}  # acknowledged: digest by name

    def upload(self, server, pose, name, k):
        capture = self.captures[k % len(self.captures)]
        request = catalog.UploadViewsRequest(parent=pose, view_id=name, view=catalog_pb2.View(
            cloud=self.clouds[k % len(self.clouds)], object_pose=capture.object_pose, sensor_pose=capture.sensor_pose))
        server.stub.UploadViews(iter([request]), timeout=30)
        full = f"{pose}/views/{name}"
        self.views[full] = digest(server.stub.GetView(catalog.GetViewRequest(name=full, detail=catalog_pb2.VIEW_DETAIL_FULL), timeout=30))
        counts["views acknowledged"] += 1

    def teach(self, server, number):
        server.stub.CreateObject(catalog.CreateObjectRequest(object_id=f"part-{number}", object=catalog_pb2.Object()))
        server.stub.CreateStablePose(catalog.CreateStablePoseRequest(
            parent=f"objects/part-{number}", stable_pose_id="flat", stable_pose=catalog_pb2.StablePose()))
        for k in range(VIEWS):
            self.upload(server, f"objects/part-{number}/stablePoses/flat", f"v{k}", k)

    def expect_refused(self, server, number):
        try:
            self.upload(server, f"objects/part-{number}/stablePoses/flat", "too-much", 0)
            counts["additions to a full disk"] += 1
        except grpc.RpcError as error:
            counts[f"additions refused as {error.code().name}"] += 1

    def delete(self, server, name):
        if "/views/" in name:
            server.stub.DeleteView(catalog.DeleteViewRequest(name=name), timeout=30)
            del self.views[name]
        else:
            server.stub.DeleteObject(catalog.DeleteObjectRequest(name=name, force=True), timeout=30)
            self.views = {view: d for view, d in self.views.items() if not view.startswith(name + "/")}
        counts["deletions on a full disk"] += 1

    def compare(self, server, expected):
        found = {}
        for item in server.stub.ListObjects(catalog.ListObjectsRequest(page_size=1000)).objects:
            for view in server.stub.ListViews(catalog.ListViewsRequest(
                    parent=item.name + "/stablePoses/flat", page_size=1000)).views:
                found[view.name] = digest(server.stub.GetView(catalog.GetViewRequest(name=view.name, detail=catalog_pb2.VIEW_DETAIL_FULL), timeout=30))
        counts["comparisons"] += 1
        counts["lost or changed"] += sum(found.get(name) != value for name, value in expected.items())
        counts["not deleted"] += sum(name not in expected for name in found)


def fill(disk):
    """Until nothing frees a byte any more, for longer than the server's watch waits."""
    full_since = time.monotonic()
    with open(disk + "/ballast", "ab", buffering=0) as file:
        while time.monotonic() - full_since < 2:
            try:
                while file.write(PAGE) == len(PAGE):
                    full_since = time.monotonic()
            except OSError:
                pass
            time.sleep(0.05)


def run(arguments):
    done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{arguments}: {done.stdout}")
    return done.stdout


def main():
    binaries, folder, rounds = sys.argv[1], sys.argv[3], int(sys.argv[4])
    disk, backups, elsewhere = OUT + "/disk", OUT + "/backups", OUT + "/elsewhere"
    shutil.rmtree(backups, ignore_errors=True)
    os.makedirs(disk, exist_ok=True)
    os.makedirs(backups)
    run(["mount", "-t", "tmpfs", "-o", "size=256m", "tmpfs", disk])
    captures = list(plant.capture_set(folder).captures)[:VIEWS]
    clouds = [plant.point_cloud(os.path.join(folder, capture.path)) for capture in captures]
    program, database = binaries + "/graspdb-server", disk + "/db"
    state = Round(captures, clouds)
    server = Server(program, database, backups)
    state.teach(server, 0)
    for number in range(1, rounds + 1):
        state.teach(server, number)
        fill(disk)
        state.expect_refused(server, number)
        state.delete(server, f"objects/part-{number}/stablePoses/flat/views/v0")
        state.delete(server, f"objects/part-{number - 1}")
        server.end(signal.SIGKILL)
        counts["kills"] += 1
        server = Server(program, database, backups)
        state.compare(server, state.views)
        fill(disk)
        state.expect_refused(server, number)
        state.delete(server, f"objects/part-{number}/stablePoses/flat/views/v1")
        run([binaries + "/graspdb", "--server", server.address, "backup", "create"])
        at_backup = dict(state.views)
        os.remove(disk + "/ballast")
        begin = time.monotonic()
        while True:
            try:
                state.upload(server, f"objects/part-{number}/stablePoses/flat", "again", 1)
                break
            except grpc.RpcError:
                time.sleep(0.05)
        slowest["writes again"] = max(slowest["writes again"], time.monotonic() - begin)
        shutil.rmtree(elsewhere, ignore_errors=True)
        run([binaries + "/graspdb", "backup", "restore", "--from", backups, "--to", elsewhere])
        restored = Server(program, elsewhere, OUT + "/backups-elsewhere")
        state.compare(restored, at_backup)
        restored.end(signal.SIGTERM)
        counts["restored elsewhere"] += 1
        state.compare(server, state.views)
        counts["rounds"] += 1
        print(number, dict(counts), file=sys.stderr, flush=True)
    server.end(signal.SIGTERM)
    print("| | |\n| --- | ---: |")
    for name, count in sorted(counts.items()):
        print(f"| {name} | {count} |")
    for name, seconds in slowest.items():
        print(f"| slowest: {name}, s | {seconds:.1f} |")
    sys.exit(1 if counts["lost or changed"] or counts["not deleted"] else 0)


OUT = sys.argv[2]
main()
