"""Frames for the agent of a cell, from the program that reads the camera."""
from __future__ import annotations

from typing import Any, Optional, Union

import numpy.typing as npt

from graspdb import _channel, errors
from graspdb.geometry import Intrinsics
from graspdb.teaching import CloudLike, scan_message
from graspdb.v1 import frame_service_pb2, frame_service_pb2_grpc


class Pusher:
    """A connection to an agent with `sensor="push:PORT"`. Thread-safe; to be used in `with`, or closed.

    Args:
      agent: HOST:PORT of the agent.
      camera: name of the camera, such as its serial number. The agent takes the frames of one camera.
      timeout_s: time limit of a call.
    """

    def __init__(self, agent: str = "127.0.0.1:7110", *, camera: str, timeout_s: float = 10.0) -> None:
        settings = _channel.Settings(agent, None, None, None, None, None, timeout_s, retry=False, busy_retries=0)
        self._agent = agent
        self._camera = camera
        self._connection, channel = _channel.connect(settings)
        self._frames = frame_service_pb2_grpc.FrameServiceStub(channel)

    def close(self) -> None:
        """Ends the connection."""
        self._connection.close()

    def __enter__(self) -> "Pusher":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def push(self, cloud: Optional[CloudLike] = None, *, depth: Optional[npt.ArrayLike] = None,
             intrinsics: Union[Intrinsics, npt.ArrayLike, None] = None, depth_unit_m: float = 0.001,
             captured: float) -> None:
        """Gives the agent a frame, which takes the place of the one before. Raises an `errors.Error`.

        Args:
          cloud, depth, intrinsics, depth_unit_m: as of `Client.recognize`, in the sensor's frame.
          captured: when the exposure started, in seconds as of `time.time()`. Read the clock before the camera is
            triggered: robots move by what the frame shows at that time, and a later one lets them pick by an old frame.
        """
        scan: "dict[str, Any]" = scan_message(cloud, depth, intrinsics, depth_unit_m, None)[0]
        nanoseconds = round(captured * 1e9)
        for message in scan.values():
            message.capture_time.FromNanoseconds(nanoseconds)
        try:
            self._frames.PushFrame(frame_service_pb2.PushFrameRequest(camera=self._camera, **scan))
        except errors.Unavailable as error:
            raise errors.Unavailable(f"no agent takes frames at {self._agent}; start graspdb-cell with "
                                     "--sensor push:PORT") from error
