"""google.rpc: that of googleapis-common-protos where it is installed, else a copy.

A process can load one of the two only. Debian 12 has no such package, and a `google/rpc` of ours would be in the way
of those who install it otherwise.
"""
try:
    from google.rpc import error_details_pb2, status_pb2
except ImportError:
    from graspdb._rpc import error_details_pb2, status_pb2

__all__ = ["error_details_pb2", "status_pb2"]
