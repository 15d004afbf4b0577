"""The published messages and stubs, generated from proto/graspdb/v1."""
