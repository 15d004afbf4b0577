"""The connection: TLS, token, time limits and retries, as the C++ client library has them."""
from __future__ import annotations

import collections
import ipaddress
import json
import os
import random
import re
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Iterator, List, Optional, Tuple

import grpc

from graspdb import errors
from graspdb.point_files import PathLike

# Calls that may be repeated without further effect: gRPC sends them again where the connection breaks or is refused,
# with four attempts within about a second.
_REPEATABLE = {
    "RecognitionService": ["Recognize", "FindLookAlikes"],
    "BackupService": ["CreateBackup", "ListBackups"],
    "CatalogService": ["GetCatalogStatus", "GetObject", "ListObjects", "GetStablePose", "ListStablePoses", "GetView",
                       "ListViews", "ReportGraspOutcome"],
    "UploadService": ["GetUpload", "CommitUpload", "ListUploads", "ListUploadViews"],
    "ObjectHistoryService": ["ListDeletedObjects", "GetDeletedObject", "ListObjectRevisions"],
    "CellService": ["GetCell", "ListCells"],
}
_RETRY_POLICY = {"maxAttempts": 4, "initialBackoff": "0.15s", "maxBackoff": "1s", "backoffMultiplier": 2,
                 "retryableStatusCodes": ["UNAVAILABLE"]}
# Those of client/sdk/client.cc, which has the reasons.
_OPTIONS: List[Tuple[str, Any]] = [
    ("grpc.initial_reconnect_backoff_ms", 100), ("grpc.max_reconnect_backoff_ms", 1000),
    ("grpc.min_reconnect_backoff_ms", 4000), ("grpc.keepalive_time_ms", 20_000), ("grpc.keepalive_timeout_ms", 10_000),
    ("grpc.per_rpc_retry_buffer_size", 256 << 20), ("grpc.max_receive_message_length", -1),
    ("grpc.max_send_message_length", -1),
]
_LONGEST_DELAY_S = 30.0  # longer ones are the caller's decision
_NO_THREAD = "Server Threadpool Exhausted"  # of gRPC, while the server has no thread for the call
_NO_THREAD_DELAY_S = 0.1


@dataclass(frozen=True)
class Settings:
    """How to connect; the arguments of Client()."""

    server: str
    ca: Optional[PathLike]
    cert: Optional[PathLike]
    key: Optional[PathLike]
    token: Optional[str]
    token_file: Optional[PathLike]
    timeout_s: float
    retry: bool
    busy_retries: int

    @property
    def uses_tls(self) -> bool:
        return bool(self.ca or self.cert or self.key)

    @property
    def is_local(self) -> bool:
        host = self.server.rpartition(":")[0].strip("[]")
        try:
            return self.server.startswith("unix:") or host == "localhost" or ipaddress.ip_address(host).is_loopback
        except ValueError:
            return False

    def check(self) -> None:
        """ValueError for settings that no connection can have."""
        match = re.fullmatch(r"unix:.+|.*:///.+|(?:\[[^\]]+\]|[^:/]+):(\d{1,5})", self.server)
        if match is None or not 0 < int(match[1] or 1) < 65536:
            raise ValueError(f"{self.server!r} is not HOST:PORT; give a server such as 127.0.0.1:50051")
        if bool(self.cert) != bool(self.key):
            raise ValueError("cert and key belong together; give both")
        if self.token is not None and self.token_file is not None:
            raise ValueError("token and token_file exclude each other; give one of them")
        if (self.token or self.token_file) and not (self.uses_tls or self.is_local):
            raise ValueError(f"the token is not sent to {self.server} without encryption; give ca")

    def read_token(self) -> Optional[str]:
        """The token, that of a file as it is now."""
        token = self.token
        if self.token_file is not None:
            with open(self.token_file, encoding="utf-8") as file:
                token = file.readline(4096).strip()
        if token is not None and not re.fullmatch(r"[!-~]{1,1024}", token):
            where = "token" if self.token_file is None else f"token_file {os.fspath(self.token_file)}"
            raise ValueError(f"{where} has no token; give one of `graspdb-server token`")
        return token


def connect(settings: Settings) -> Tuple[grpc.Channel, grpc.Channel]:
    """A channel, and the same one with token, time limits, retries and our errors; close the first."""
    settings.check()
    settings.read_token()
    options = list(_OPTIONS)
    if settings.retry:
        names = [{"service": f"graspdb.v1.{service}", "method": method}
                 for service, methods in _REPEATABLE.items() for method in methods]
        options.append(("grpc.service_config", json.dumps(
            {"methodConfig": [{"name": names, "retryPolicy": _RETRY_POLICY}]})))
    options.append(("grpc.enable_retries", int(settings.retry)))
    if settings.is_local:
        options.append(("grpc.enable_http_proxy", 0))
    if settings.uses_tls:
        ca, key, cert = (_read(path) for path in (settings.ca, settings.key, settings.cert))
        channel = grpc.secure_channel(settings.server, grpc.ssl_channel_credentials(ca, key, cert), options)
    else:
        channel = grpc.insecure_channel(settings.server, options)
    return channel, grpc.intercept_channel(channel, _Interceptor(settings, channel))


def _read(path: Optional[PathLike]) -> Optional[bytes]:
    if path is None:
        return None
    with open(path, "rb") as file:
        return file.read()


class Retries:
    """The pauses before a call is sent again: the server's delay and a random part of a span that grows."""

    def __init__(self, limit: int) -> None:
        self._limit = self._left = limit
        self._span_s = 0.0

    def reset(self) -> None:
        """After a success, all are left again."""
        self._left, self._span_s = self._limit, 0.0

    def pause_s(self, delay_s: Optional[float]) -> Optional[float]:
        """Seconds before the next attempt; None if `delay_s` is, or no attempt is left."""
        if delay_s is None or self._left <= 0:
            return None
        self._left -= 1
        self._span_s = min(2 * self._span_s or max(delay_s, 0.001), 1.0)
        return delay_s + random.random() * self._span_s


def busy_delay_s(error: errors.Error) -> Optional[float]:
    """The delay of a busy server, which has not begun the call; None for other errors."""
    if not isinstance(error, errors.ResourceExhausted):
        return None
    if str(error) == _NO_THREAD:
        return _NO_THREAD_DELAY_S
    delay_s = error.retry_delay_s
    return delay_s if delay_s is not None and 0 <= delay_s <= _LONGEST_DELAY_S else None


class _Details(collections.namedtuple("_Details", "method timeout metadata credentials wait_for_ready compression"),
               grpc.ClientCallDetails):  # type: ignore[misc]
    pass


class _Interceptor(grpc.UnaryUnaryClientInterceptor, grpc.UnaryStreamClientInterceptor,  # type: ignore[misc]
                   grpc.StreamUnaryClientInterceptor, grpc.StreamStreamClientInterceptor):  # type: ignore[misc]
    """Of all calls, also those by the stubs."""

    def __init__(self, settings: Settings, channel: grpc.Channel) -> None:
        self._settings = settings
        self._reconnection = _Reconnection(channel)

    def intercept_unary_unary(self, continuation: Callable[..., Any], details: Any, request: Any) -> Any:
        timeout_s = details.timeout if details.timeout is not None else self._settings.timeout_s
        end = time.monotonic() + timeout_s
        retries = Retries(self._settings.busy_retries if self._settings.retry else 0)
        while True:
            call = continuation(self._with_token(details, end - time.monotonic()), request)
            error = self._error_of(call)
            if error is None:
                return call
            pause_s = retries.pause_s(busy_delay_s(error))
            if pause_s is None or time.monotonic() + pause_s >= end:
                raise error
            time.sleep(pause_s)

    def intercept_stream_unary(self, continuation: Callable[..., Any], details: Any, requests: Any) -> Any:
        call = continuation(self._with_token(details, details.timeout), requests)
        error = self._error_of(call)
        if error is not None:
            raise error
        return call

    def intercept_unary_stream(self, continuation: Callable[..., Any], details: Any, request: Any) -> Any:
        return _Responses(continuation(self._with_token(details, details.timeout), request), self._explain)

    intercept_stream_stream = intercept_unary_stream

    def _with_token(self, details: Any, timeout_s: Optional[float]) -> _Details:
        token = self._settings.read_token()
        metadata = list(details.metadata or ()) + ([("authorization", "Bearer " + token)] if token else [])
        return _Details(details.method, None if timeout_s == float("inf") else timeout_s, metadata,
                        details.credentials, details.wait_for_ready, details.compression)

    def _error_of(self, call: Any) -> Optional[errors.Error]:
        """Of a call that has ended."""
        failure = call.exception()
        if failure is None:
            return None
        if not isinstance(failure, grpc.RpcError):
            raise failure
        return self._explain(failure)

    def _explain(self, call: Any) -> errors.Error:
        error = errors.error_of_call(call)
        # The server's own errors have details; gRPC's describe sockets.
        if error.details.details or not isinstance(error, errors.Unavailable):
            return error
        self._reconnection.begin()
        return errors.Unavailable(_connection_advice(str(error), self._settings))


class _Responses:
    """The responses of a stream, whose errors are ours; it has all methods of the call, such as cancel()."""

    def __init__(self, call: Any, explain: Callable[[Any], errors.Error]) -> None:
        self._call = call
        self._explain = explain

    def __iter__(self) -> Iterator[Any]:
        return self

    def __next__(self) -> Any:
        try:
            return next(self._call)
        except grpc.RpcError as failure:
            raise self._explain(failure) from None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._call, name)


class _Reconnection:
    """Connects again after a call has failed without a connection, until that succeeds.

    gRPC reads from a socket only while a call waits, and after an attempt to connect has failed, calls do not wait but
    fail: with TLS, calls once a second then never succeed again (client/sdk/connection.h). So one call waits.
    """

    def __init__(self, channel: grpc.Channel) -> None:
        # Of the health service: it needs neither messages of ours nor an identity.
        self._check = channel.unary_unary("/grpc.health.v1.Health/Check", bytes, bytes)
        self._lock = threading.Lock()
        self._call: Any = None

    def begin(self) -> None:
        with self._lock:
            if self._call is None or self._call.done():
                self._call = self._check.future(b"", wait_for_ready=True)


def _connection_advice(text: str, settings: Settings) -> str:
    """What gRPC's text of a failed connection means, as client/sdk/security.cc explains it."""
    advice = ""
    if "certificate verify failed" in text or "CERTIFICATE_VERIFY_FAILED" in text:
        ca = "the system; give ca" if settings.ca is None else f"ca {os.fspath(settings.ca)}"
        advice = f"its certificate has expired or is not signed by an authority of {ca}"
    elif "Hostname Verification" in text or "does not match SSL server name" in text:
        advice = "its certificate is for other host names; give a server with a name that its subjectAltName has"
    elif "wrong version number" in text or "WRONG_VERSION_NUMBER" in text:
        advice = "it does not use TLS; leave out ca, cert and key"
    elif "failed to connect" in text and "Socket closed" in text:
        if not settings.uses_tls:
            advice = "it closed the connection; give ca if it uses TLS"
        elif settings.cert is None:
            advice = "it needs a client certificate; give cert and key"
        else:
            advice = f"it does not accept cert {os.fspath(settings.cert)}"
    if advice:
        return f"cannot connect to the server at {settings.server}: {advice}"
    return (f"no graspdb server is reachable at {settings.server}; start graspdb-server or give Client(\"HOST:PORT\") "
            f"({text})")
