"""refused.py AUDIT_LOG: calls that the server must refuse, and the traces that they leave."""
import json
import os
import sys

import plant
from graspdb import errors
from graspdb.v1 import catalog_service_pb2


def delete_object(name):
    """Deletes an object as the caller `name`; returns the error."""
    with plant.client(name) as client:
        try:
            client.catalog.DeleteObject(catalog_service_pb2.DeleteObjectRequest(name="objects/wedge", force=True))
        except errors.Error as error:
            return error
    raise AssertionError(f"the server accepted {name}")


def new_lines(file):
    """The lines that were added to a file since the last call."""
    return file.read().splitlines()


def check_call(audit, name, error_class, identity, why):
    """A refused call has its line in the audit log: who, from where, what, why."""
    error = delete_object(name)
    assert isinstance(error, error_class)
    (record,) = map(json.loads, new_lines(audit))
    print(record)
    assert record.get("identity", "") == identity and record["peer"].startswith("ipv")
    assert record["method"] == "graspdb.v1.CatalogService.DeleteObject" and record["resources"] == ["objects/wedge"]
    assert record["code"] == error.code.name and why in record["error"]


def check_connection(audit, name, why):
    """A refused certificate ends the connection before any call: its lines, one for each attempt, have the subject."""
    assert isinstance(delete_object(name), errors.Unavailable)
    records = [json.loads(line) for line in new_lines(audit)]
    print(records[0])
    for record in records:
        assert record["method"] == "TLS handshake" and f"CN={name}" in record["error"] and why in record["error"]


def main():
    with open(sys.argv[1], encoding="utf-8") as audit:
        audit.seek(0, os.SEEK_END)
        check_call(audit, "press-3", errors.PermissionDenied, "press-3", "lacks the role teach")
        check_call(audit, None, errors.Unauthenticated, "", "known callers only")
        check_connection(audit, "expired", "certificate has expired")
        check_connection(audit, "stranger", "unable to get local issuer certificate")


main()
