"""Errors of calls, with the server's advice.

Every call raises an `Error` of the class of its gRPC code. Its text is the server's sentence, which states what to
do next; docs/errors.md has all codes and reasons.
"""
from __future__ import annotations

import enum
from typing import Any, Dict, Optional, Tuple, Type

import grpc

from graspdb._rpc import error_details_pb2, status_pb2


class Reason(str, enum.Enum):
    """Why a call failed: the reason of the ErrorInfo, which is the name of the code where there is none of its own."""

    QUEUE_FULL = "QUEUE_FULL"
    STREAMS_FULL = "STREAMS_FULL"
    CALLS_FULL = "CALLS_FULL"
    MEMORY_FULL = "MEMORY_FULL"
    REQUEST_ID_REUSED = "REQUEST_ID_REUSED"
    EMPTY_REGION = "EMPTY_REGION"
    NO_CLUSTER = "NO_CLUSTER"
    SEVERAL_CLUSTERS = "SEVERAL_CLUSTERS"
    INVALID_ARGUMENT = "INVALID_ARGUMENT"
    NOT_FOUND = "NOT_FOUND"
    ALREADY_EXISTS = "ALREADY_EXISTS"
    FAILED_PRECONDITION = "FAILED_PRECONDITION"
    ABORTED = "ABORTED"
    OUT_OF_RANGE = "OUT_OF_RANGE"
    UNAUTHENTICATED = "UNAUTHENTICATED"
    PERMISSION_DENIED = "PERMISSION_DENIED"
    RESOURCE_EXHAUSTED = "RESOURCE_EXHAUSTED"
    UNAVAILABLE = "UNAVAILABLE"
    CANCELLED = "CANCELLED"
    DEADLINE_EXCEEDED = "DEADLINE_EXCEEDED"
    DATA_LOSS = "DATA_LOSS"
    INTERNAL = "INTERNAL"
    OTHER = "OTHER"
    """One that this version of the client does not have; `Error.details` has it."""

    @classmethod
    def _missing_(cls, value: object) -> "Reason":
        return cls.OTHER


class Error(Exception):
    """A call that failed. `str()` of it is one sentence with advice."""

    code: grpc.StatusCode
    """The gRPC code."""
    reason: Reason
    """The reason in the details."""
    fields: Tuple[Tuple[str, str], ...]
    """The fields of the request that are wrong, each with its description."""
    retry_delay_s: Optional[float]
    """Seconds after which the same call may succeed; None where a retry is of no use."""
    request_id: str
    """The id of the call in the server's log; empty where the server was not reached."""
    details: Any
    """The google.rpc.Status with all details."""

    def __init__(self, message: str, status: Any = None, request_id: str = "") -> None:
        super().__init__(message)
        self.code = _CODE_OF_CLASS.get(type(self), grpc.StatusCode.UNKNOWN)
        self.details = status if status is not None else status_pb2.Status()
        self.request_id = request_id
        self.reason = Reason(self.code.name)
        self.fields = ()
        self.retry_delay_s = None
        for detail in self.details.details:
            info, fields, retry = (error_details_pb2.ErrorInfo(), error_details_pb2.BadRequest(),
                                   error_details_pb2.RetryInfo())
            if detail.Unpack(info):
                self.reason = Reason(info.reason)
            elif detail.Unpack(fields):
                self.fields = tuple((each.field, each.description) for each in fields.field_violations)
            elif detail.Unpack(retry):
                self.retry_delay_s = retry.retry_delay.ToNanoseconds() / 1e9


class InvalidArgument(Error, ValueError):
    """The request is wrong whatever the state of the catalogue; `fields` has the field."""


class NotFound(Error):
    """There is no record with this name."""


class AlreadyExists(Error):
    """The name is taken, by other content."""


class FailedPrecondition(Error):
    """The request is right, but not in this state of the catalogue, or for this capture."""


class Aborted(Error):
    """Another call was first: read the record again, and repeat the change."""


class OutOfRange(Error):
    """The revision is not kept, or belongs to another catalogue: read all records again."""


class Unauthenticated(Error):
    """The server does not know the caller: give a token or a certificate."""


class PermissionDenied(Error):
    """The caller's identity lacks the role."""


class ResourceExhausted(Error):
    """A queue, memory, disk or limit is full; with `retry_delay_s` the call has not begun."""


class Unavailable(Error):
    """No server is reachable, it stops, or its disk failed."""


class Cancelled(Error):
    """The caller ended the call."""


class DeadlineExceeded(Error):
    """The time limit passed; a change may have been made."""


class DataLoss(Error):
    """Bytes on the server's disk are damaged."""


class Internal(Error):
    """A fault of the server or of one of its libraries."""


class UploadFailed(FailedPrecondition):
    """Views of a bulk upload cannot be taught, so that none of its views is in the catalogue."""

    failed: Tuple[Tuple[str, Error], ...] = ()
    """Name and error of each."""


_CLASSES: Dict[grpc.StatusCode, Type[Error]] = {
    grpc.StatusCode.INVALID_ARGUMENT: InvalidArgument,
    grpc.StatusCode.NOT_FOUND: NotFound,
    grpc.StatusCode.ALREADY_EXISTS: AlreadyExists,
    grpc.StatusCode.FAILED_PRECONDITION: FailedPrecondition,
    grpc.StatusCode.ABORTED: Aborted,
    grpc.StatusCode.OUT_OF_RANGE: OutOfRange,
    grpc.StatusCode.UNAUTHENTICATED: Unauthenticated,
    grpc.StatusCode.PERMISSION_DENIED: PermissionDenied,
    grpc.StatusCode.RESOURCE_EXHAUSTED: ResourceExhausted,
    grpc.StatusCode.UNAVAILABLE: Unavailable,
    grpc.StatusCode.CANCELLED: Cancelled,
    grpc.StatusCode.DEADLINE_EXCEEDED: DeadlineExceeded,
    grpc.StatusCode.DATA_LOSS: DataLoss,
    grpc.StatusCode.INTERNAL: Internal,
}
_CODE_OF_CLASS = {error_class: code for code, error_class in _CLASSES.items()}
_CODE_OF_CLASS[UploadFailed] = grpc.StatusCode.FAILED_PRECONDITION
_CODE_OF_NUMBER = {code.value[0]: code for code in grpc.StatusCode}


def make_error(code: grpc.StatusCode, message: str, status: Any = None, request_id: str = "") -> Error:
    """An error of the class of `code`, with the details of a google.rpc.Status."""
    error = _CLASSES.get(code, Error)(message, status, request_id)
    error.code = code
    return error


def error_of_status(status: Any) -> Error:
    """The error of a google.rpc.Status within a response."""
    return make_error(_CODE_OF_NUMBER.get(status.code, grpc.StatusCode.UNKNOWN), status.message, status)


def error_of_call(call: Any) -> Error:
    """The error of a gRPC call that has failed."""
    trailing = {key: value for key, value in call.trailing_metadata() or ()}
    status = status_pb2.Status()
    try:
        status.ParseFromString(trailing.get("grpc-status-details-bin", b""))
    except Exception:  # of another program than graspdb-server: the code and the text stay
        status = status_pb2.Status()
    return make_error(call.code(), call.details() or call.code().name, status, trailing.get("x-request-id", ""))
