// graspdb_hostile HOST:PORT: sends malicious scans and measures a server's time for each, the delay
// until it is free after the caller has cancelled, and its resident memory.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "files/messages/scan_message.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "recognition/base/types.h"

namespace graspdb::bench {
namespace {

using Clock = std::chrono::steady_clock;
using recognition::Points;

std::mt19937_64 random_numbers(7);

float Uniform(double low, double high) {
  return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random_numbers));
}

Points InBox(std::size_t count, double size_m, double depth_m) {
  Points out(count);
  for (auto& p : out) {
    p = {Uniform(-size_m, size_m), Uniform(-size_m, size_m),
         static_cast<float>(depth_m) + Uniform(-size_m, size_m)};
  }
  return out;
}

// The upper side and front of a box of 10 x 6 x 5 cm, 0.6 m before the camera.
Points Part() {
  Points out;
  for (int i = 0; i < 12'000; ++i) {
    out.emplace_back(Uniform(-0.05, 0.05), Uniform(-0.03, 0.03), 0.6F);
    if (i % 2 == 0) out.emplace_back(Uniform(-0.05, 0.05), 0.03F, Uniform(0.6, 0.65));
  }
  return out;
}

// A table 0.65 m before the camera, with the part on it.
Points Table() {
  Points out = Part();
  for (int i = 0; i < 200'000; ++i) out.emplace_back(Uniform(-0.5, 0.5), Uniform(-0.5, 0.5), 0.65F);
  return out;
}

Points With(Points points, const Points& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

struct Case {
  std::string name;
  v1::RecognizeRequest request;
};

v1::RecognizeRequest Cloud(const Points& points, bool segmented, double region_m = 0) {
  v1::RecognizeRequest out;
  *out.mutable_cloud() = files::CloudMessage(points, 0);
  out.set_segmented(segmented);
  if (region_m > 0) {
    out.mutable_sensor_pose()->mutable_orientation()->set_w(1);
    auto* box = out.mutable_region_of_interest();
    for (auto [corner, sign] : {std::pair(box->mutable_min(), -1), {box->mutable_max(), 1}}) {
      corner->set_x(sign * region_m);
      corner->set_y(sign * region_m);
      corner->set_z(sign * region_m);
    }
  }
  return out;
}

v1::RecognizeRequest NoiseImage(int width, int height, bool segmented, int low, int high) {
  v1::RecognizeRequest out;
  auto* camera = out.mutable_depth_image()->mutable_intrinsics();
  camera->set_width(width);
  camera->set_height(height);
  camera->set_fx(0.9 * width);
  camera->set_fy(0.9 * width);
  camera->set_cx(0.5 * width);
  camera->set_cy(0.5 * height);
  std::string& data = *out.mutable_depth_image()->mutable_data();
  for (int i = 0; i < width * height; ++i) {
    const auto depth =
        static_cast<std::uint16_t>(std::uniform_int_distribution(low, high)(random_numbers));
    data.append({static_cast<char>(depth & 0xff), static_cast<char>(depth >> 8)});
  }
  out.set_segmented(segmented);
  return out;
}

Points Row(std::size_t count, double length_m) {
  Points out;
  for (std::size_t i = 0; i < count; ++i) {
    out.emplace_back(
        static_cast<float>(length_m * static_cast<double>(i) / static_cast<double>(count)), 0.0F,
        0.6F);
  }
  return out;
}

std::vector<Case> Cases() {
  std::vector<Case> out;
  const auto add = [&](std::string name, v1::RecognizeRequest request) {
    out.push_back({std::move(name), std::move(request)});
  };
  add("part alone", Cloud(Part(), true));
  add("2 strays 3 m away", Cloud(With(Part(), {{3, 0, 0.6F}, {0, 3, 3}}), true));
  for (const double far : {0.9, 1.5, 8.0, 80.0}) {
    add("50 strays " + std::to_string(far).substr(0, 4) + " m away, segmented",
        Cloud(With(Part(), InBox(50, far, 0.6)), true));
    add("table, region 50 m, 50 strays at " + std::to_string(far).substr(0, 4) + " m",
        Cloud(With(Table(), InBox(50, far, 0.6)), false, 50));
  }
  add("500 strays at 9 m, region 50 m", Cloud(With(Table(), InBox(500, 9, 0)), false, 50));
  for (const double size : {0.05, 0.3, 0.49, 3.0}) {
    const std::string box = std::to_string(2 * size).substr(0, 4) + " m";
    add("300,000 points in a box of " + box + ", segmented", Cloud(InBox(300'000, size, 1), true));
    add("300,000 points in a box of " + box, Cloud(InBox(300'000, size, 1), false, 20));
  }
  add("2,000,000 points in a box of 1 m", Cloud(InBox(2'000'000, 0.5, 1), false, 20));
  add("2,000,000 points in a box of 1 m, segmented", Cloud(InBox(2'000'000, 0.5, 1), true));
  add("2,000,000 points in a box of 8 m", Cloud(InBox(2'000'000, 4, 4), false, 50));
  add("2,000,000 points in one voxel", Cloud(InBox(2'000'000, 0.001, 0.6), false, 1));
  add("2,000,000 points in one place", Cloud(Points(2'000'000, {0.1F, 0.1F, 0.6F}), false, 1));
  add("half of 400,000 points in one place",
      Cloud(With(InBox(200'000, 0.4, 1), Points(200'000, {0.1F, 0.1F, 0.6F})), false, 20));
  for (const float depth : {1e-9F, 1e-30F, 1e-3F, -1.0F}) {
    add("points at depth " + std::to_string(depth),
        Cloud(With(Part(), {{0, 1e-9F, depth}, {0.02F, 0.01F, depth}}), true));
  }
  add("all at depth 1e-9 m", Cloud(Points(5000, {1e-9F, 1e-9F, 1e-9F}), true));
  add("noise 64 x 48, segmented", NoiseImage(64, 48, true, 1, 65535));
  add("noise 640 x 480, segmented", NoiseImage(640, 480, true, 300, 1300));
  add("noise 640 x 480, segmented, all depths", NoiseImage(640, 480, true, 1, 65535));
  add("noise 640 x 480", NoiseImage(640, 480, false, 500, 1500));
  add("noise 1600 x 1200", NoiseImage(1600, 1200, false, 300, 8000));
  add("thin noise 640 x 480, segmented", NoiseImage(640, 480, true, 595, 605));
  add("one row of 100,000 points, 0.9 m", Cloud(Row(100'000, 0.9), true));
  add("one row of 2,000,000 points, 90 m", Cloud(Row(2'000'000, 90), false, 50));
  add("one row image", NoiseImage(100'000, 1, true, 400, 1400));
  return out;
}

class Prober {
 public:
  explicit Prober(const std::string& server) {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto connect = [&] {
      return grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
    };
    recognition_ = v1::RecognitionService::NewStub(connect());
    catalog_ = v1::CatalogService::NewStub(connect());
    // On a separate connection, so that the rest of a large message in transit does not count.
    other_ = v1::RecognitionService::NewStub(connect());
    small_ = Cloud(Points(60, {0.1F, 0.1F, 0.6F}), true);
  }

  // ms; the status by name in `outcome`.
  double Send(const v1::RecognizeRequest& request, std::string* outcome) {
    return Send(*recognition_, request, outcome);
  }
  double Send(v1::RecognitionService::Stub& service, const v1::RecognizeRequest& request,
              std::string* outcome) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
    v1::RecognizeResponse response;
    const auto start = Clock::now();
    const grpc::Status status = service.Recognize(&context, request, &response);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    *outcome = status.ok() ? v1::RecognitionStatus_Name(response.status())
                           : "error " + std::to_string(status.error_code()) + ": " +
                                 status.error_message().substr(0, 60);
    if (response.untried_view_count() > 0)
      *outcome += ", untried " + std::to_string(response.untried_view_count());
    if (response.search_timed_out()) *outcome += ", timed out";
    const v1::StageReport* slowest = nullptr;
    for (const v1::StageReport& stage : response.stages()) {
      if (slowest == nullptr || stage.duration_ms() > slowest->duration_ms()) slowest = &stage;
    }
    slowest_ = slowest == nullptr
                   ? ""
                   : slowest->stage() + " " + std::to_string(std::lround(slowest->duration_ms()));
    return ms;
  }

  // Time from the cancellation of the call until a server with one worker answers the next one, ms.
  double FreeAfterCancel(const v1::RecognizeRequest& request, double after_ms) {
    grpc::ClientContext context;
    std::thread call([&] {
      v1::RecognizeResponse response;
      (void)recognition_->Recognize(&context, request, &response);
    });
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(after_ms));
    context.TryCancel();
    std::string outcome;
    const double ms = Send(*other_, small_, &outcome);
    call.join();
    return ms;
  }

  // Of the last answer, with its time in ms.
  const std::string& slowest_stage() const { return slowest_; }

  double ResidentMib() {
    grpc::ClientContext context;
    v1::CatalogStatus status;
    (void)catalog_->GetCatalogStatus(&context, {}, &status);
    return static_cast<double>(status.memory().resident_byte_count()) / (1 << 20);
  }

 private:
  std::unique_ptr<v1::RecognitionService::Stub> recognition_;
  std::unique_ptr<v1::RecognitionService::Stub> other_;
  std::unique_ptr<v1::CatalogService::Stub> catalog_;
  v1::RecognizeRequest small_;
  std::string slowest_;
};

void Run(const std::string& server) {
  Prober prober(server);
  std::printf(
      "| scan | answer | ms | slowest stage, ms | free after cancel, ms | resident, MiB |\n");
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  for (const Case& c : Cases()) {
    std::string outcome;
    const double ms = prober.Send(c.request, &outcome);
    const std::string slowest = prober.slowest_stage();
    double free = 0;
    for (const double share : {0.3, 0.6, 0.85}) {
      if (ms > 30) free = std::max(free, prober.FreeAfterCancel(c.request, share * ms));
    }
    std::printf("| %s | %s | %.0f | %s | %.0f | %.0f |\n", c.name.c_str(), outcome.c_str(), ms,
                slowest.c_str(), free, prober.ResidentMib());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace graspdb::bench

int main(int argc, char** argv) {
  CLI::App app(
      "graspdb_hostile sends malicious scans to a server (start it with --workers 1) and prints "
      "the "
      "time for each, the delay until it is free for the next call after a cancelled one, and its "
      "resident memory.",
      "graspdb_hostile");
  std::string server;
  app.add_option("SERVER", server, "HOST:PORT")->required();
  CLI11_PARSE(app, argc, argv);
  graspdb::bench::Run(server);
  return 0;
}
