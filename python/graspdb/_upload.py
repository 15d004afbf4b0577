"""Bulk uploads: views that become part of the catalogue together (upload_service.proto)."""
from __future__ import annotations

import itertools
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Iterator, List, Optional, Sequence, Set, Tuple

from graspdb import errors
from graspdb._channel import Retries, busy_delay_s
from graspdb._progress import OnProgress
from graspdb.teaching import View
from graspdb.v1 import catalog_service_pb2, upload_service_pb2

# Views of one stream. Twice as many take twice the memory, and save the time of a call, a few milliseconds.
_BATCH = 8
_DELAY_S = 0.1  # before a lost stream is opened again


@dataclass(frozen=True)
class UploadResult:
    """What a bulk upload did."""

    created: int
    """Views that are new in the catalogue."""
    existing: int
    """Views that the catalogue had."""
    replaced: int
    catalog_revision: int
    """From which on the catalogue has the views."""
    failed: Tuple[Tuple[str, errors.Error], ...]
    """Name and error of each view that cannot be taught and was left out."""


class Upload:
    """One upload, with all of its streams."""

    def __init__(self, uploads: Any, upload_id: str, views: Sequence[View], known: Set[str], replace: bool,
                 busy_retries: int, report: OnProgress) -> None:
        self._uploads = uploads
        self._name = f"uploads/{upload_id}"
        self._views = views
        self._replace = replace
        self._busy_retries = busy_retries
        self._report = report
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._left: Iterator[View] = iter(views)
        self._done = 0
        self._existing = 0
        self._failed: List[Tuple[str, errors.Error]] = []
        self._known = known  # in the catalogue
        self._staged: Set[str] = set()  # sent by an upload that was interrupted

    def run(self, streams: int, skip_failed: bool) -> UploadResult:
        self._open()
        streams = max(1, min(streams, len(self._views)))
        with ThreadPoolExecutor(streams) as pool:
            try:
                for stream in [pool.submit(self._stream) for _ in range(streams)]:
                    stream.result()
            except BaseException:
                self._stop.set()
                raise
        failed = tuple(sorted(self._failed, key=lambda each: each[0]))
        if failed and not skip_failed:
            name, first = failed[0]
            error = errors.UploadFailed(
                f"{len(failed)} of {len(self._views)} views cannot be taught, so that none is ({name}: {first}); correct "
                "them and upload again, or publish the others with skip_failed=True")
            error.failed = failed
            raise error
        upload = self._uploads.CommitUpload(
            upload_service_pb2.CommitUploadRequest(name=self._name, skip_failed=skip_failed), timeout=float("inf"))
        return UploadResult(upload.created_count, upload.existing_count + self._existing, upload.replaced_count,
                            upload.commit_revision, failed)

    def _open(self) -> None:
        """Creates the upload, or continues one that was interrupted."""
        request = upload_service_pb2.CreateUploadRequest(
            upload_id=self._name.partition("/")[2],
            upload=upload_service_pb2.Upload(replace=self._replace, expected_view_count=len(self._views)))
        try:
            upload = self._uploads.GetUpload(upload_service_pb2.GetUploadRequest(name=self._name))
        except errors.NotFound:
            self._uploads.CreateUpload(request)
            return
        if upload.state == upload_service_pb2.UPLOAD_STATE_COMMITTED:
            self._uploads.DeleteUpload(upload_service_pb2.DeleteUploadRequest(name=self._name))
            self._uploads.CreateUpload(request)
            return
        pages = upload_service_pb2.ListUploadViewsRequest(parent=self._name, page_size=1000)
        while True:
            page = self._uploads.ListUploadViews(pages)
            self._staged.update(view.name for view in page.views if not view.HasField("error"))
            pages.page_token = page.next_page_token
            if not pages.page_token:
                return

    def _stream(self) -> None:
        """Sends views until none are left."""
        while not self._stop.is_set():
            with self._lock:
                views = list(itertools.islice(self._left, _BATCH))
            if not views:
                return
            try:
                self._send([request for request in map(self._prepare, views) if request is not None])
            except BaseException:
                self._stop.set()
                raise

    def _prepare(self, view: View) -> Optional[upload_service_pb2.WriteUploadViewsRequest]:
        """The request for a view; None if the server has it."""
        message = view.message()
        name = f"{message.parent}/views/{message.view_id}"
        if name in self._staged or name in self._known:
            self._count(existing=name in self._known)
            return None
        return upload_service_pb2.WriteUploadViewsRequest(upload=self._name, view=message)

    def _send(self, requests: List[upload_service_pb2.WriteUploadViewsRequest]) -> None:
        """Sends views; those without a response again, until no attempt has got one for the retries of a call."""
        retries = Retries(self._busy_retries)
        while requests and not self._stop.is_set():
            try:
                for response in self._uploads.WriteUploadViews(iter(list(requests))):
                    del requests[0]
                    retries.reset()
                    self._count(failed=response if response.HasField("error") else None)
                if requests:
                    raise errors.Unavailable("the stream ended early")
            except errors.Error as error:
                pause_s = retries.pause_s(_delay_s(error))
                if pause_s is None:
                    raise _with_advice(error) from None
                self._stop.wait(pause_s)

    def _count(self, existing: bool = False,
               failed: Optional[upload_service_pb2.WriteUploadViewsResponse] = None) -> None:
        with self._lock:
            if failed is not None:
                self._failed.append((failed.view, errors.error_of_status(failed.error)))
            self._existing += existing
            self._done += 1
            self._report(self._done, len(self._views))


def _delay_s(error: errors.Error) -> Optional[float]:
    """Seconds after which the views may be sent again; None if that is of no use."""
    is_lost = isinstance(error, errors.Unavailable)
    is_reset = isinstance(error, errors.Internal) and not error.request_id  # by gRPC, and not by the server
    return _DELAY_S if is_lost or is_reset else busy_delay_s(error)


def _with_advice(error: errors.Error) -> errors.Error:
    if not isinstance(error, errors.Unavailable):
        return error
    return errors.Unavailable(f"{error}; the views sent are safe, upload again with the same id to go on",
                              error.details, error.request_id)


def view_names(catalog: Any, stable_poses: Set[str]) -> Set[str]:
    """The views that the catalogue has of stable poses."""
    names: Set[str] = set()
    for stable_pose in stable_poses:
        request = catalog_service_pb2.ListViewsRequest(parent=stable_pose, page_size=1000)
        while True:
            page = catalog.ListViews(request)
            names.update(view.name for view in page.views)
            request.page_token = page.next_page_token
            if not request.page_token:
                break
    return names
