"""burst.py HOST:PORT SET CALLERS ROUNDS: callers that send at the same moment, each with a connection of its own.

First frames of a capture set, then views of it. Prints how the calls ended as a Markdown table: without retries, and with
retries as docs/api.md describes them. Needs the folders of the Python client and of the fifth example in PYTHONPATH.
"""
import collections
import os
import random
import sys
import threading
import time

import grpc

import graspdb
import plant
from graspdb.v1 import (catalog_pb2, catalog_service_pb2, catalog_service_pb2_grpc, recognition_service_pb2,
                        recognition_service_pb2_grpc)

MAX_RETRIES = 12


def outcome(call, retries):
    """The way in which it ended."""
    for k in range(retries + 1):
        try:
            call()
            return "answered"
        except grpc.RpcError as error:
            delay = graspdb.errors.error_of_call(error).retry_delay_s
            if error.code() != grpc.StatusCode.RESOURCE_EXHAUSTED or delay is None:
                return f"{error.code().name}, {'no' if delay is None else 'a'} RetryInfo: {error.details()[:60]}"
        time.sleep(delay + random.uniform(0, 0.05 * 2 ** k))
    return "RESOURCE_EXHAUSTED with RetryInfo"


class Caller(threading.Thread):
    def __init__(self, address, make_calls, start, retries):
        super().__init__()
        self.channel = grpc.insecure_channel(address, options=[("grpc.use_local_subchannel_pool", 1)])
        grpc.channel_ready_future(self.channel).result(timeout=60)
        self.calls = make_calls(self.channel)
        self.start_together = start
        self.retries = retries
        self.outcomes = collections.Counter()

    def run(self):
        self.start_together.wait()
        for call in self.calls:
            self.outcomes[outcome(call, self.retries)] += 1


def burst(name, address, callers, retries, make_calls):
    start = threading.Barrier(callers)
    threads = [Caller(address, lambda channel, k=k: make_calls(channel, k), start, retries) for k in range(callers)]
    for thread in threads:
        thread.start()
    outcomes = collections.Counter()
    for thread in threads:
        thread.join()
        outcomes += thread.outcomes
        thread.channel.close()
    for ending, count in sorted(outcomes.items()):
        print(f"| {name} | {'yes' if retries else 'no'} | {ending} | {count} |", flush=True)


def main():
    address, folder, callers, rounds = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    captures = plant.capture_set(folder).captures
    frames = [recognition_service_pb2.RecognizeRequest(
        cloud=graspdb.geometry.cloud_message(graspdb.read_points(os.path.join(folder, capture.path)).points), sensor_pose=capture.sensor_pose)
        for capture in captures[:8]]

    def recognise(channel, _):
        stub = recognition_service_pb2_grpc.RecognitionServiceStub(channel)
        return [lambda k=k: stub.Recognize(frames[k % len(frames)], timeout=60) for k in range(rounds)]

    view_ids = iter(range(10 ** 9))

    def teach(channel, _):
        stub = catalog_service_pb2_grpc.CatalogServiceStub(channel)
        capture = captures[0]
        requests = [catalog_service_pb2.UploadViewsRequest(
            parent=f"objects/{capture.object_id}/stablePoses/{capture.stable_pose_id}", view_id=f"burst-{next(view_ids)}",
            view=catalog_pb2.View(cloud=frames[0].cloud, object_pose=capture.object_pose, sensor_pose=capture.sensor_pose))
            for _ in range(rounds)]
        return [lambda request=request: stub.UploadViews(iter([request]), timeout=60) for request in requests]

    print("| calls | retries | ended with | |\n| --- | --- | --- | ---: |")
    for retries in (0, MAX_RETRIES):
        burst("frames", address, callers, retries, recognise)
        burst("views", address, callers, retries, teach)


main()
