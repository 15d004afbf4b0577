#!/usr/bin/python3
"""openapi_test.py PROTOC SOURCE [BIN]: docs/openapi.json is that of the contract, and with the programs in BIN its schemas are those
of what calls through the console take and give."""
import base64
import json
import os
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

PROTOC, SOURCE = sys.argv[1:3]
BIN = sys.argv[3] if len(sys.argv) > 3 else None
FILE = os.path.join(SOURCE, "docs", "openapi.json")
with open(FILE, encoding="utf-8") as text:
    DOCUMENT = json.load(text)

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}
# What the generator writes; another keyword has to be checked below.
KEYWORDS = {"$ref", "type", "properties", "additionalProperties", "required", "items", "enum", "format", "contentEncoding", "description"}


def resolve(reference):
    out = DOCUMENT
    for part in reference.removeprefix("#/").split("/"):
        out = out[part]
    return out


def mistakes(schema, value, at="$"):
    """Where `value` is not as `schema` has it."""
    assert set(schema) <= KEYWORDS, set(schema) - KEYWORDS
    if "$ref" in schema:
        return mistakes(resolve(schema["$ref"]), value, at)
    kind = schema.get("type")
    if kind and (not isinstance(value, TYPES[kind]) or (isinstance(value, bool) and kind != "boolean")):
        return [f"{at}: {value!r} is no {kind}"]
    out = []
    if "enum" in schema and value not in schema["enum"]:
        out.append(f"{at}: {value!r}")
    if schema.get("format") == "int64" and not value.lstrip("-").isdigit():
        out.append(f"{at}: {value!r} is no number")
    if schema.get("contentEncoding") == "base64":
        base64.b64decode(value + "=" * (-len(value) % 4), validate=True)
    if kind == "object":
        properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
        out += [f"{at}: has no {name}" for name in schema.get("required", []) if name not in value]
        for name, each in value.items():
            if name in properties:
                out += mistakes(properties[name], each, f"{at}.{name}")
            elif others is False:
                out.append(f"{at}: {name} is unknown")
            elif isinstance(others, dict):
                out += mistakes(others, each, f"{at}.{name}")
    if kind == "array":
        for i, each in enumerate(value):
            out += mistakes(schema["items"], each, f"{at}[{i}]")
    return out


def references(value):
    if isinstance(value, dict):
        if "$ref" in value:
            yield value["$ref"]
        for each in value.values():
            yield from references(each)
    elif isinstance(value, list):
        for each in value:
            yield from references(each)


class Document(unittest.TestCase):
    def test_is_of_the_contract(self):
        made = subprocess.run([os.path.join(SOURCE, "console/openapi.py"), PROTOC, os.path.join(SOURCE, "proto")],
                              check=True, capture_output=True, text=True).stdout
        with open(FILE, encoding="utf-8") as text:
            self.assertTrue(made == text.read(), "run: console/openapi.py protoc proto >docs/openapi.json")

    def test_references_lead_somewhere(self):
        for reference in set(references(DOCUMENT)):
            resolve(reference)
        names = [operation["post"]["operationId"] for operation in DOCUMENT["paths"].values()]
        self.assertEqual(len(names), len(set(names)))

    def test_finds_mistakes(self):
        schema = {"$ref": "#/components/schemas/Object"}
        self.assertEqual(mistakes(schema, {"name": "objects/x", "labels": ["a"], "release": "RELEASE_STATE_DRAFT"}), [])
        for wrong in ({"nam": "x"}, {"name": 1}, {"labels": "a"}, {"release": "DRAFT"}):
            self.assertEqual(len(mistakes(schema, wrong)), 1, wrong)


@unittest.skipUnless(BIN, "the console is not built")
class Calls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.programs = []
        server = cls.start("graspdb-server", "--db", os.path.join(cls.folder.name, "db"), "--listen", "127.0.0.1:0")
        cls.url = cls.start("graspdb-console", "--server", server, "--listen", "127.0.0.1:0").rstrip("/")

    @classmethod
    def start(cls, program, *arguments):
        child = subprocess.Popen([os.path.join(BIN, program), *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        cls.programs.append(child)
        return child.stdout.readline().split()[-1]

    @classmethod
    def tearDownClass(cls):
        for child in reversed(cls.programs):
            child.terminate()
            child.wait()
            child.stdout.close()
        cls.folder.cleanup()

    def call(self, method, request, status=200):
        """Sends `request`, which has to be as the document has it, and the response too."""
        post = DOCUMENT["paths"][f"/graspdb.v1.{method}"]["post"]
        self.assertEqual(mistakes(post["requestBody"]["content"]["application/json"]["schema"], request), [], method)
        call = urllib.request.Request(f"{self.url}/graspdb.v1.{method}", json.dumps(request).encode(), {"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(call, timeout=60) as answer:
                code, body = answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            with error:
                code, body = error.code, json.load(error)
        self.assertEqual(code, status, body)
        response = post["responses"]["200" if code == 200 else "default"]
        self.assertEqual(mistakes(response["content"]["application/json"]["schema"], body), [], method)
        return body

    def test_requests_and_responses(self):
        pose = {"position": {"x": 0.1, "y": 0, "z": 0.2}, "orientation": {"w": 1}}
        box = {"min": {"x": -1, "y": -1, "z": 0}, "max": {"x": 1, "y": 1, "z": 1}}
        self.call("CatalogService/CreateObject", {"objectId": "box", "object": {"labels": ["a"], "release": "RELEASE_STATE_DRAFT"}})
        made = self.call("CatalogService/CreateStablePose", {
            "parent": "objects/box", "stablePoseId": "up",
            "stablePose": {"symmetryOrder": 2, "minScore": 0.6, "grasps": [
                {"graspId": "top", "tcpPose": pose, "gripperOpeningM": 0.05, "freeTurn": {"minDeg": -10, "maxDeg": 10}}]}})
        self.assertEqual(made["grasps"][0]["gripperOpeningM"], 0.05)
        self.call("CatalogService/UpdateStablePose",
                  {"stablePose": {"name": made["name"], "displayName": "Up", "etag": made["etag"]}, "updateMask": "displayName"})
        self.call("CatalogService/UpdateStablePose",
                  {"stablePose": {"name": made["name"], "displayName": "Down", "etag": made["etag"]}, "updateMask": "displayName"}, 409)
        self.call("CatalogService/ReportGraspOutcome", {"name": made["name"], "graspId": "top", "outcome": "GRASP_OUTCOME_PICKED"})
        self.assertEqual(self.call("CatalogService/GetStablePose", {"name": made["name"]})["graspOutcomes"][0]["pickedCount"], "1")
        self.call("CatalogService/ListObjects", {"pageSize": 1})
        self.call("CatalogService/GetCatalogStatus", {})
        self.call("CellService/CreateCell", {"cellId": "one", "cell": {
            "sensorPose": pose, "regionOfInterest": box, "pipeline": {"minScore": 0.4, "verifiedViewCount": 10}}})
        self.call("CellService/ListCells", {})
        self.call("RecognitionService/FindLookAlikes", {})
        self.call("RecognitionService/Recognize", {"cell": "cells/none", "depthImage": {"intrinsics": {"width": 4}}}, 404)
        field = {"type": "NUMERIC_TYPE_FLOAT32"}
        answer = self.call("RecognitionService/Recognize", {"segmented": True, "cloud": {
            "pointStride": 12, "fields": [{**field, "name": name, "offset": 4 * i} for i, name in enumerate("xyz")],
            "data": base64.b64encode(bytes([0, 0, 128, 63] * 3 * 50)).decode()}})
        self.assertGreater(len(answer["stages"]), 0)
        self.call("ObjectHistoryService/ListObjectRevisions", {"parent": "objects/box"})
        self.call("UploadService/CreateUpload", {"uploadId": "first", "upload": {"expectedViewCount": "5"}})
        self.call("UploadService/ListUploads", {})
        self.call("CatalogService/GetObject", {"name": "objects/none"}, 404)
        self.call("CatalogService/DeleteObject", {"name": "objects/box", "force": True})

    def test_names_each_method(self):
        """Those of the document are all that the gateway forwards in JSON."""
        for path, item in DOCUMENT["paths"].items():
            kind = next(iter(item["post"]["requestBody"]["content"]))
            call = urllib.request.Request(self.url + path, b"{", {"Content-Type": kind})
            try:
                with urllib.request.urlopen(call, timeout=60) as answer:
                    self.assertEqual(kind, "application/connect+json", path)
                    self.assertIn(b"invalid_argument", answer.read())
            except urllib.error.HTTPError as error:
                with error:
                    self.assertEqual((error.code, json.load(error)["code"]), (400, "invalid_argument"), path)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
