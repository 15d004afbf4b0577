// graspdb_bulk: the rate of a bulk upload beside RocksDB's own for the same bytes in the same run.
#include <rocksdb/db.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/teaching/upload/bulk_upload.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/sample_parts.h"
#include "tests/bench/seen_parts.h"

namespace graspdb::bench {
namespace {

struct Options {
  std::string folder;
  std::string server;
  std::size_t views = 20'000;
  std::size_t points = 2'000;  // 24 KB as floats
  int streams = 4;
  bool upload_only = false;
};

// The views that are sent: parts scaled by other factors each time, their points repeated or left
// out so that each has the same number.
class Views {
 public:
  explicit Views(const Options& options)
      : options_(options), parts_(rendering::SampleParts()), seen_(SeeParts(parts_)) {
    Stretches stretches(parts_.size());
    for (std::size_t i = 0; i < options.views; i += seen_.size()) {
      factors_.push_back(stretches.Next());
    }
  }

  static std::string StablePoseOf(std::size_t i) {
    return absl::StrCat("objects/bulk/stablePoses/", i / 1000);
  }

  absl::Status Make(std::size_t i, v1::UploadViewsRequest* request) const {
    const SeenPart& seen = seen_[i % seen_.size()];
    const Stretch stretch(seen, factors_[i / seen_.size()][seen.part]);
    const Eigen::Isometry3f sensor_world = seen.world_sensor.inverse().cast<float>();
    recognition::Points points;
    points.reserve(options_.points);
    for (std::size_t k = 0; k < options_.points; ++k) {
      const std::size_t at = k * seen.points.size() / options_.points;
      points.push_back(sensor_world * stretch(seen.points[at]));
    }
    request->set_parent(StablePoseOf(i));
    request->set_view_id(absl::StrCat("v", i));
    v1::View& view = *request->mutable_view();
    *view.mutable_cloud() = files::CloudMessage(points, 0);
    view.set_segmented(true);
    *view.mutable_sensor_pose() = files::ToMessage(seen.world_sensor);
    *view.mutable_object_pose() = files::ToMessage(seen.world_object);
    return absl::OkStatus();
  }

 private:
  const Options& options_;
  const std::vector<rendering::Workpiece> parts_;
  const std::vector<SeenPart> seen_;
  std::vector<std::vector<Eigen::Vector3f>> factors_;
};

// User and system time of this process and all its threads, s.
double ProcessorTime() {
  rusage used = {};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// Runs `work` for each view on as many threads as there are streams; the seconds that it took.
template <typename Work>
double OnStreams(const Options& options, const Work& work) {
  const absl::Time start = absl::Now();
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(options.streams));
  for (int t = 0; t < options.streams; ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < options.views; i = next++) work(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
  return absl::ToDoubleSeconds(absl::Now() - start);
}

// Seconds to put all clouds, as they are sent, into a database of default options, each write
// synced. Negative on an error.
double PutAll(const Options& options, const Views& views) {
  const std::string path = options.folder + "/rocksdb";
  std::filesystem::remove_all(path);
  rocksdb::Options database_options;
  database_options.create_if_missing = true;
  rocksdb::DB* opened = nullptr;
  if (!rocksdb::DB::Open(database_options, path, &opened).ok()) return -1;
  const std::unique_ptr<rocksdb::DB> database(opened);
  rocksdb::WriteOptions synced;
  synced.sync = true;
  std::atomic<bool> failed = false;
  const double seconds = OnStreams(options, [&](std::size_t i) {
    v1::UploadViewsRequest request;
    const bool made = views.Make(i, &request).ok();
    failed = failed || !made ||
             !database->Put(synced, request.view_id(), request.view().cloud().data()).ok();
  });
  return failed ? -1 : seconds;
}

absl::StatusOr<double> UploadAll(const Options& options, const Views& views) {
  client::Client client({.server = options.server});
  v1::CapturedObject object;
  object.set_object_id("bulk");
  for (std::size_t i = 0; i < options.views; i += 1000) {
    object.add_stable_poses()->set_stable_pose_id(absl::StrCat(i / 1000));
  }
  if (absl::Status made = client::CreateParents(client, {object}); !made.ok()) return made;
  const absl::Time start = absl::Now();
  const auto result = client::TeachInBulk(
      client,
      {.count = options.views,
       .make = [&](std::size_t i,
                   v1::UploadViewsRequest* request) { return views.Make(i, request); }},
      {.upload_id = "bulk", .streams = options.streams, .atomic = true}, {});
  if (!result.ok()) return result.status();
  return absl::ToDoubleSeconds(absl::Now() - start);
}

int Report(const absl::Status& error) {
  std::fprintf(stderr, "graspdb_bulk: %s\n", std::string(error.message()).c_str());
  return 1;
}

int Run(const Options& options) {
  std::filesystem::create_directories(options.folder);
  const Views views(options);
  const double megabytes = 12e-6 * static_cast<double>(options.points * options.views);
  if (options.upload_only) {
    const absl::StatusOr<double> upload = UploadAll(options, views);
    if (!upload.ok()) return Report(upload.status());
    std::printf("committed after %.1f s\n", *upload);
    return 0;
  }
  const double making = OnStreams(options, [&](std::size_t i) {
    v1::UploadViewsRequest request;
    views.Make(i, &request).IgnoreError();
  });
  const double before_puts = ProcessorTime();
  const double raw = PutAll(options, views);
  const double before_upload = ProcessorTime();
  const absl::StatusOr<double> upload = UploadAll(options, views);
  const double after_upload = ProcessorTime();
  if (raw < 0) return Report(absl::InternalError("RocksDB failed"));
  if (!upload.ok()) return Report(upload.status());
  std::printf("making the views alone: %.1f s\n", making);
  const double ms_a_view = 1e3 / static_cast<double>(options.views);
  std::printf("RocksDB, synced puts: %.1f s, %.1f MB/s\n", raw, megabytes / raw);
  std::printf("bulk upload, committed: %.1f s, %.1f MB/s, %.0f views/s: %.0f %% of that\n", *upload,
              megabytes / *upload, static_cast<double>(options.views) / *upload,
              100 * raw / *upload);
  std::printf("processor time of this process: %.2f ms a put, %.2f ms an uploaded view\n",
              (before_upload - before_puts) * ms_a_view,
              (after_upload - before_upload) * ms_a_view);
  return 0;
}

}  // namespace
}  // namespace graspdb::bench

int main(int argc, char** argv) {
  CLI::App app(
      "graspdb_bulk uploads views to a running server in one bulk upload, and puts the same bytes "
      "into a RocksDB database by synced writes from as many threads. It continues an interrupted "
      "upload.",
      "graspdb_bulk");
  graspdb::bench::Options options;
  app.add_option("FOLDER", options.folder, "For RocksDB's database; on the server's disk")
      ->required();
  app.add_option("--server", options.server, "HOST:PORT")->required();
  app.add_option("--views", options.views, "Number of views")->capture_default_str();
  app.add_option("--points", options.points, "Points of a view, 12 bytes each")
      ->capture_default_str();
  app.add_option("--streams", options.streams, "Streams and threads")->capture_default_str();
  app.add_flag("--upload-only", options.upload_only, "Without RocksDB's part");
  CLI11_PARSE(app, argc, argv);
  return graspdb::bench::Run(options);
}
