"""Connections to the plant's server, and the frames of a capture set."""
import os

from google.protobuf import json_format

import graspdb
from graspdb.v1 import capture_set_pb2, catalog_service_pb2


def client(name=None):
    """A client that trusts the plant's authority only. `name`.pem and `name`.key are the caller's identity."""
    cert, key = (name + ".pem", name + ".key") if name else (None, None)
    return graspdb.Client("127.0.0.1:50051", ca="plant.pem", cert=cert, key=key)


def connect(name):
    """The same after the server has started and accepted the certificate."""
    out = client(name)
    out.catalog.GetCatalogStatus(catalog_service_pb2.GetCatalogStatusRequest(), wait_for_ready=True, timeout=60)
    return out


def capture_set(folder):
    """The objects and frames of a folder."""
    with open(os.path.join(folder, "captures.json"), encoding="utf-8") as file:
        return json_format.Parse(file.read(), capture_set_pb2.CaptureSet())
