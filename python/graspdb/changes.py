"""Changes of the catalogue, and outcomes of grasps."""
from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any, Iterable, Iterator, List, Optional, Tuple

from graspdb.results import _Enum
from graspdb.v1 import change_service_pb2


class ChangeKind(_Enum):
    """What happened to a resource."""

    UNSPECIFIED = 0
    WRITTEN = 1
    DELETED = 2


class Outcome(_Enum):
    """The outcome of a pick attempt."""

    UNSPECIFIED = 0
    PICKED = 1
    """The object was taken and stayed in the gripper."""
    MISSED = 2
    """The gripper closed on nothing."""
    SLIPPED = 3
    """The object was taken and lost again."""


@dataclass(frozen=True)
class ChangedResource:
    """A resource that was written or deleted."""

    name: str
    kind: ChangeKind
    record: Any
    """The message after the change, with `include_records` and where the server sends it; else None."""


@dataclass(frozen=True)
class Change:
    """One change of the catalogue; without resources, a heartbeat."""

    catalog_revision: int
    """After the change. All changes up to it were received."""
    catalog_id: str
    """Of the catalogue; send both to go on later."""
    time: Optional[datetime.datetime]
    """In UTC; None for a heartbeat."""
    resources: Tuple[ChangedResource, ...]


def changes_of(responses: Iterable[change_service_pb2.WatchCatalogResponse]) -> Iterator[Change]:
    """Whole changes of the parts in which large ones are sent; ends the call when it is closed."""
    resources: List[ChangedResource] = []
    try:
        for response in responses:
            for change in response.changes:
                record = change.WhichOneof("record")
                resources.append(ChangedResource(change.name, ChangeKind(change.kind),
                                                 getattr(change, record) if record else None))
            if response.continued:
                continue
            time = None
            if response.HasField("change_time"):
                time = response.change_time.ToDatetime().replace(tzinfo=datetime.timezone.utc)
            yield Change(response.catalog_revision, response.catalog_id, time, tuple(resources))
            resources = []
    finally:
        cancel = getattr(responses, "cancel", None)
        if cancel is not None:
            cancel()
