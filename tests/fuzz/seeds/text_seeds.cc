#include <cstdint>
#include <cstring>
#include <vector>

#include "client/cell/robots/gri/gri_message.h"
#include "tests/fuzz/range_image_input.h"
#include "tests/fuzz/seeds/seed_writer.h"

namespace graspdb::fuzz {
namespace {

std::string Gri(client::GriAction action, int format) {
  client::GriRequest request;
  request.action = static_cast<std::uint8_t>(action);
  request.pose_format = static_cast<std::uint8_t>(format);
  request.job_id = 1;
  request.pose.rotation = {1'000'000, 0, 0, 0};
  request.data = {0, 1, 0, 0};
  const auto bytes = client::GriBytes(request);
  return {bytes.begin(), bytes.end()};
}

void WriteRobots(const SeedWriter& out) {
  using client::GriAction;
  out.Write("robots", "gri-sync",
            Gri(GriAction::kTriggerJobSync, 1) + Gri(GriAction::kGetRelatedPose, 3) +
                Gri(GriAction::kGetNextPose, 51));
  out.Write("robots", "gri-async",
            Gri(GriAction::kTriggerJobAsync, 20) + Gri(GriAction::kGetJobStatus, 20) +
                Gri(GriAction::kStatus, 20));
  out.Write("robots", "gri-calibration",
            Gri(GriAction::kHecInit, 1) + Gri(GriAction::kHecSetPose, 1) +
                Gri(GriAction::kHecCalibrate, 1));
  out.Write(
      "robots", "line-run",
      "STATUS\nFORMAT STAUBLI\r\nRUN 1 300 0 200 0 180 0\nRELATED 1\nGRASP 1\nNEXT 1\nPICKED\n"
      "MISSED\nHELP\nQUIT\n");
  out.Write("robots", "line-start",
            "FORMAT 1 START 2 1 2 3 1 0 0 0\nSTATE 2\nFORMAT KUKA NEXT 2\nNEXT 3\nRUN 4\nRUN 5\n"
            "SLIPPED\n");
}

void WriteHttp(const SeedWriter& out) {
  const std::string host = "Host: localhost:8080\r\n";
  const std::string objects = "POST /graspdb.v1.CatalogService/ListObjects HTTP/1.1\r\n" + host;
  const std::string watch = "POST /graspdb.v1.ChangeService/WatchCatalog HTTP/1.1\r\n" + host;
  out.Write("http", "page",
            "GET /?a HTTP/1.1\r\n" + host +
                "Accept-Encoding: gzip\r\n\r\nHEAD /console.js HTTP/1.1\r\n" + host +
                "If-None-Match: \"2\"\r\n\r\nGET /none HTTP/1.1\r\n" + host + "\r\n");
  out.Write("http", "json",
            objects +
                "Origin: http://localhost:8080\r\nSec-Fetch-Site: same-origin\r\nContent-Type: "
                "application/json\r\nContent-Length: 14\r\nConnect-Timeout-Ms: "
                "1000\r\n\r\n{\"pageSize\":1}" +
                objects +
                "Content-Type: application/proto\r\nContent-Length: 2\r\nAuthorization: Bearer "
                "x\r\nX-Request-Id: a1\r\nConnection: close\r\n\r\n\x08\x01");
  out.Write("http", "chunked",
            objects +
                "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\nExpect: "
                "100-continue\r\n\r\n2;a=b\r\n{}\r\n0\r\nA: b\r\n\r\n");
  out.Write("http", "stream",
            watch +
                "Content-Type: application/connect+json\r\nConnect-Protocol-Version: "
                "1\r\nContent-Length: 7\r\n\r\n" +
                std::string("\0\0\0\0\x02{}", 7) + watch +
                "Content-Type: application/connect+proto\r\nContent-Length: 5\r\n\r\n" +
                std::string(5, '\0'));
  out.Write("http", "refused",
            "POST /graspdb.v1.UploadService/WriteUploadViews HTTP/1.1\r\n" + host +
                "Content-Type: application/proto\r\nContent-Length: 0\r\n\r\n" + objects +
                "Content-Type: text/plain\r\nContent-Length: 9999\r\n\r\n");
}

void WriteSettings(const SeedWriter& out) {
  out.Write("settings", "server",
            "--db=/var/lib/graspdb\n--workers=2\nGRASPDB_QUEUE=8\nmax-points=1000000\n"
            "listen=\"127.0.0.1:0\"\ndescriptor=vfh308\nlog-level=\"off\"\n");
  out.Write("settings", "agent",
            "--cell=press-3\n--sensor=simulated\nGRASPDB_LINE_FORMAT=ABB\n"
            "job=[\"1 any\",\"2 object=flange primary=object limit=500ms\",\"91 outcome=picked\"]\n"
            "calibrate=[\"0 target=block mount=fixed region=0.3\"]\nallow-remote-robots=true\n"
            "# a comment\n[section]\nsensor: simulated:parts=l-bracket+flange,seed=3,rate=2\n"
            "sensor: files:/a/b?width=640&height=480&fx=500&fy=500&cx=320&cy=240&once\n");
  out.Write("settings", "help", "--help\n--version\n");
}

void WriteFrames(const SeedWriter& out) {
  out.Write("frames", "two.json",
            R"([{"frame":"frames/a.pcd","sensor":"x","objects":[)"
            R"({"object":"can","mesh":"can.ply","meshUnit":"mm","T_sensor_mesh":)"
            R"([[0,-1,0,0.1],[1,0,0,-0.2],[0,0,1,0.8],[0,0,0,1]]},{"object":null},)"
            R"({"object":"box","mesh":"box.obj","meshUnit":"m","T_sensor_mesh":null}]}])"
            "\n");
}

void WriteIdentities(const SeedWriter& out) {
  out.Write(
      "identities", "two.jsonl",
      "# callers\n\n"
      R"({"name":"engineer","roles":["ROLE_ADMIN"],"certificates":["uri:spiffe://plant/e","cn:press-3"]})"
      "\n"
      R"({"name":"press-3","roles":["ROLE_READ","ROLE_RECOGNISE"],"cell":"cells/press-3",)"
      R"("tokenSha256":["PEaenWxYddN6Q/NT1PiOYfz4EsZu7jRXRlpAsNpBU+A="]})"
      "\n");
}

template <typename Number>
void WriteRangeImage(const SeedWriter& out, const std::string& name, const RangeImageHeader& header,
                     const std::vector<Number>& values) {
  std::string bytes(sizeof(header) + sizeof(Number) * values.size(), '\0');
  std::memcpy(bytes.data(), &header, sizeof(header));
  std::memcpy(bytes.data() + sizeof(header), values.data(), sizeof(Number) * values.size());
  out.Write("range_image", name, bytes);
}

void WriteRangeImages(const SeedWriter& out) {
  const std::vector<std::uint16_t> counts = {4000, 0, 3000, 65535};
  const std::vector<std::uint16_t> disparities = {1280, 0, 640, 2560};
  const std::vector<std::uint16_t> points = {100, 200, 4000, 0, 0, 0, 300, 400, 5000, 1, 2, 3000};
  WriteRangeImage(out, "depth", {.format = 0, .mode = 1, .unit = 1}, counts);
  WriteRangeImage(out, "offset", {.format = 0, .mode = 1, .unit = 1, .offset = 100}, counts);
  WriteRangeImage(out, "disparity", {.format = 0, .mode = 3, .unit = 4}, disparities);
  WriteRangeImage(out, "floats", {.format = 1, .mode = 1, .unit = 2},
                  std::vector<float>{100, 0, 200, 400});
  WriteRangeImage(out, "points", {.format = 3, .mode = 2, .unit = 1},
                  std::vector<float>(points.begin(), points.end()));
  WriteRangeImage(out, "integer-points", {.format = 2, .mode = 2, .unit = 1}, points);
}

}  // namespace

void WriteTextSeeds(const SeedWriter& out) {
  WriteIdentities(out);
  WriteFrames(out);
  WriteHttp(out);
  WriteRobots(out);
  WriteRangeImages(out);
  WriteSettings(out);
}

}  // namespace graspdb::fuzz
