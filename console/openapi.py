#!/usr/bin/python3
"""openapi.py PROTOC PROTO: prints the OpenAPI 3.1 document of the calls that graspdb-console forwards, from the contract in
the folder PROTO. docs/openapi.json is its output:

    console/openapi.py protoc proto >docs/openapi.json
"""
import glob
import json
import os
import subprocess
import sys
import tempfile

from google.protobuf import descriptor_pb2

Field = descriptor_pb2.FieldDescriptorProto

# As the JSON mapping of Protocol Buffers has them: 64 bits are text, since JavaScript's numbers have 53.
SCALARS = {
    Field.TYPE_DOUBLE: {"type": "number", "format": "double"},
    Field.TYPE_FLOAT: {"type": "number", "format": "float"},
    Field.TYPE_INT32: {"type": "integer", "format": "int32"},
    Field.TYPE_INT64: {"type": "string", "format": "int64"},
    Field.TYPE_FIXED32: {"type": "integer", "format": "uint32"},
    Field.TYPE_BOOL: {"type": "boolean"},
    Field.TYPE_STRING: {"type": "string"},
    Field.TYPE_BYTES: {"type": "string", "contentEncoding": "base64"},
}

WELL_KNOWN = {
    ".google.protobuf.Timestamp": {"type": "string", "format": "date-time"},
    ".google.protobuf.FieldMask": {"type": "string", "description": "Names of fields, separated by commas, as in JSON."},
    ".google.protobuf.Empty": {"type": "object", "additionalProperties": False},
    ".google.protobuf.Any": {"type": "object", "required": ["@type"], "properties": {"@type": {"type": "string"}}},
}

ERROR_CODES = [
    "canceled", "unknown", "invalid_argument", "deadline_exceeded", "not_found", "already_exists", "permission_denied",
    "resource_exhausted", "failed_precondition", "aborted", "out_of_range", "unimplemented", "internal", "unavailable",
    "data_loss", "unauthenticated",
]
ERROR = {
    "description": "An error of the Connect protocol; docs/errors.md of graspdb has the reasons.",
    "type": "object",
    "required": ["code"],
    "properties": {
        "code": {"type": "string", "enum": ERROR_CODES},
        "message": {"type": "string"},
        "details": {"type": "array", "items": {
            "type": "object",
            "required": ["type", "value"],
            "properties": {
                "type": {"type": "string", "description": "A message, such as google.rpc.ErrorInfo."},
                "value": {"type": "string", "contentEncoding": "base64", "description": "Its bytes."},
                "debug": {"description": "The same as JSON."},
            },
        }},
    },
}

STREAM = ("Request and responses are in envelopes: a byte 0, the length as four bytes (big-endian), and the message. The last "
          "envelope has the byte 2 and `{}`, or `{\"error\": …}` as of Error.")


def file_set(protoc, proto):
    """The descriptors of the contract, with its comments."""
    files = sorted(glob.glob("graspdb/v1/*_service.proto", root_dir=proto))
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "contract.pb")
        subprocess.run([protoc, f"-I{proto}", "--include_imports", "--include_source_info", f"--descriptor_set_out={out}", *files],
                       check=True)
        with open(out, "rb") as descriptors:
            return descriptor_pb2.FileDescriptorSet.FromString(descriptors.read())


def one_line(text):
    return " ".join(text.split())


class Contract:
    """The messages, enums and services of a set of files by their names, with their comments."""

    def __init__(self, files):
        self.messages, self.enums, self.services, self.comments = {}, {}, [], {}
        for file in files.file:
            self.comments.update({(file.name, *each.path): one_line(each.leading_comments)
                                  for each in file.source_code_info.location if each.leading_comments})
            for i, message in enumerate(file.message_type):
                self._add_message("." + file.package, message, (file.name, 4, i))
            for i, enum in enumerate(file.enum_type):
                self.enums[f".{file.package}.{enum.name}"] = (enum, (file.name, 5, i))
            for i, service in enumerate(file.service):
                self.services.append((f"{file.package}.{service.name}", service, (file.name, 6, i)))

    def _add_message(self, scope, message, path):
        name = f"{scope}.{message.name}"
        self.messages[name] = (message, path)
        for i, nested in enumerate(message.nested_type):
            self._add_message(name, nested, (*path, 3, i))
        for i, enum in enumerate(message.enum_type):
            self.enums[f"{name}.{enum.name}"] = (enum, (*path, 4, i))

    def comment(self, path):
        return self.comments.get(path, "")


class Schemas:
    """Schemas of the messages that calls have, and of those within them."""

    def __init__(self, contract):
        self._contract = contract
        self.all = {"Error": ERROR}

    def of_type(self, name):
        """A reference to the schema of a message or an enum."""
        if name in WELL_KNOWN:
            return dict(WELL_KNOWN[name])
        key = name.removeprefix(".graspdb.v1.").removeprefix(".")
        if key not in self.all:
            self.all[key] = {}  # messages may contain each other
            self.all[key] = self._of_enum(name) if name in self._contract.enums else self._of_message(name)
        return {"$ref": f"#/components/schemas/{key}"}

    def _of_enum(self, name):
        enum, path = self._contract.enums[name]
        values = [f"{value.name}: {self._contract.comment((*path, 2, i))}" for i, value in enumerate(enum.value)]
        return {"description": "\n".join([self._contract.comment(path), "", *values]), "type": "string",
                "enum": [value.name for value in enum.value]}

    def _of_message(self, name):
        message, path = self._contract.messages[name]
        properties = {field.json_name: self._of_field(message, field, self._contract.comment((*path, 2, i)))
                      for i, field in enumerate(message.field)}
        return {"description": self._contract.comment(path), "type": "object", "properties": properties,
                "additionalProperties": False}

    def _of_field(self, message, field, comment):
        entry = self._contract.messages.get(field.type_name, (None,))[0]
        if entry is not None and entry.options.map_entry:
            out = {"type": "object", "additionalProperties": self._of_value(entry.field[1])}
        elif field.label == Field.LABEL_REPEATED:
            out = {"type": "array", "items": self._of_value(field)}
        else:
            out = self._of_value(field)
        if field.HasField("oneof_index") and not field.proto3_optional:
            others = [other.json_name for other in message.field
                      if other.HasField("oneof_index") and other.oneof_index == field.oneof_index and other.name != field.name]
            comment += f" Not together with {', '.join(others)}." if others else ""
        return {**out, "description": comment}

    def _of_value(self, field):
        if field.type in (Field.TYPE_MESSAGE, Field.TYPE_ENUM):
            return self.of_type(field.type_name)
        return dict(SCALARS[field.type])


# graspdb.v1.role, of authorization.proto, as protoc leaves it without the generated code: an unknown field of the options.
ROLE_TAG = 50801 << 3


def role_of(method, roles):
    """The name of the role that a caller needs; None for calls of an agent."""
    data = method.options.SerializeToString()
    numbers = []
    at = 0
    while at < len(data):
        tag, at = varint(data, at)
        value, at = varint(data, at)  # the contract's options are numbers
        if tag == ROLE_TAG:
            numbers.append(value)
    return next((value.name.removeprefix("ROLE_").lower() for value in roles.value if [value.number] == numbers), None)


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return value, at


def operation(schemas, service, method, comment, role):
    request, response = schemas.of_type(method.input_type), schemas.of_type(method.output_type)
    is_stream = method.server_streaming or method.client_streaming
    kind = "application/connect+json" if is_stream else "application/json"
    return {
        "tags": [service],
        "operationId": f"{service}_{method.name}",
        "summary": comment.split(". ")[0].rstrip(".") + ".",
        "description": f"{comment}{' ' + STREAM if is_stream else ''}\n\nRole: {role}.",
        "parameters": [{"$ref": "#/components/parameters/timeout"}],
        "requestBody": {"required": True, "content": {kind: {"schema": request}}},
        "responses": {
            "200": {"description": "The stream of responses." if is_stream else "The response.", "content": {kind: {"schema": response}}},
            "default": {"description": "An error.", "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Error"}}}},
        },
    }


def document(contract):
    schemas = Schemas(contract)
    roles = contract.enums[".graspdb.v1.Role"][0]
    paths, tags, of_one = {}, [], []
    for full_name, service, path in contract.services:
        if role_of(service.method[0], roles) is None:
            continue  # of an agent, which the console does not call
        tags.append({"name": service.name, "description": contract.comment(path)})
        for i, method in enumerate(service.method):
            if method.client_streaming:
                of_one.append(f"{service.name}.{method.name}")
            comment = contract.comment((*path, 2, i))
            paths[f"/{full_name}/{method.name}"] = {"post": operation(schemas, service.name, method, comment, role_of(method, roles))}
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "graspdb",
            "version": "v1",
            "license": {"name": "Apache-2.0", "identifier": "Apache-2.0"},
            "description": "The calls of graspdb.v1 as `graspdb console` forwards them, by the Connect protocol in JSON. Of those that take a "
                           f"stream of requests each call takes one request: {', '.join(of_one)}.",
        },
        "servers": [{"url": "http://127.0.0.1:8080"}],
        "security": [{}, {"token": []}],
        "tags": tags,
        "paths": paths,
        "components": {
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer", "description": "A token of `graspdb-server token`."}},
            "parameters": {"timeout": {
                "name": "Connect-Timeout-Ms", "in": "header", "required": False, "schema": {"type": "integer", "minimum": 0},
                "description": "Milliseconds until the call is DEADLINE_EXCEEDED.",
            }},
            "schemas": dict(sorted(schemas.all.items())),
        },
    }


def main():
    protoc, proto = sys.argv[1:]
    json.dump(document(Contract(file_set(protoc, proto))), sys.stdout, indent=1, ensure_ascii=False)
    print()


if __name__ == "__main__":
    main()
