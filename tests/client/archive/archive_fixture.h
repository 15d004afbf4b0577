// Two servers and archives between them.
#pragma once

#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/archive/archive_export.h"
#include "client/archive/archive_import.h"
#include "server/server.h"
#include "tests/files/temporary_folder.h"
#include "tests/server/sample_captures.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {

using ::graspdb::testing::IsOk;

class ArchiveTest : public ::testing::Test {
 protected:
  // An open file with its index.
  struct Opened {
    std::unique_ptr<files::ArchiveFile> file;
    files::ArchiveIndex index;
    OpenArchive archive() const { return {*file, index}; }
  };

  // The object of a sample part and its stable pose "flat", with the part's grasps.
  static void Declare(Client& client, const std::string& part) {
    v1::CreateObjectRequest object;
    object.set_object_id(part);
    object.mutable_object()->set_display_name("The " + part);
    object.mutable_object()->add_labels("bin-7");
    ASSERT_THAT(client.CreateObject(object), IsOk());
    v1::CreateStablePoseRequest pose;
    pose.set_parent("objects/" + part);
    pose.set_stable_pose_id("flat");
    for (const v1::Grasp& grasp : testing::Part(part).grasps) {
      *pose.mutable_stable_pose()->add_grasps() = grasp;
    }
    ASSERT_THAT(client.CreateStablePose(pose), IsOk());
  }

  static std::string PoseOf(const std::string& part) {
    return "objects/" + part + "/stablePoses/flat";
  }

  // A view of the part on a table; without a pose of the object if `estimated`.
  static void Teach(Client& client, const std::string& part, const std::string& id, double turn_deg,
                    bool estimated = false) {
    const testing::Frame frame = testing::Photograph(part, {.x = 0.01, .turn_deg = turn_deg}, 11);
    bool sent = false;
    const auto taught = client.UploadViews([&](v1::UploadViewsRequest* request) {
      request->set_parent(PoseOf(part));
      request->set_view_id(id);
      *request->mutable_view()->mutable_depth_image() = testing::DepthImageOf(frame);
      *request->mutable_view()->mutable_sensor_pose() = testing::PoseMessage(frame.world_sensor);
      if (!estimated) {
        *request->mutable_view()->mutable_object_pose() = testing::PoseMessage(frame.world_object);
      }
      return !std::exchange(sent, true);
    });
    ASSERT_THAT(taught, IsOk());
  }

  // Three turned views.
  static void DeclareAndTeach(Client& client, const std::string& part, bool estimated = false) {
    Declare(client, part);
    for (int i = 0; i < 3; ++i) {
      Teach(client, part, "turn-" + std::to_string(i), 7 + 25 * i, estimated);
    }
  }

  static void SetMinScore(Client& client, const std::string& part, double min_score) {
    v1::UpdateStablePoseRequest request;
    request.mutable_stable_pose()->set_name(PoseOf(part));
    request.mutable_stable_pose()->set_min_score(min_score);
    request.mutable_update_mask()->add_paths("min_score");
    ASSERT_THAT(client.UpdateStablePose(request), IsOk());
  }

  static double MinScore(Client& client, const std::string& part) {
    const auto pose = client.GetStablePose(PoseOf(part));
    EXPECT_THAT(pose, IsOk());
    return pose.ok() ? pose->min_score() : -1;
  }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  Opened Export(Client& client, const std::string& name, const std::vector<std::string>& ids = {}) {
    const auto written = ExportArchive(client, ids, Path(name), {});
    EXPECT_THAT(written, IsOk());
    return Open(name);
  }

  Opened Open(const std::string& name) const {
    auto file = files::ArchiveFile::Open(Path(name));
    EXPECT_THAT(file, IsOk());
    auto index = files::IndexArchive(**file, nullptr);
    EXPECT_THAT(index, IsOk());
    return {.file = *std::move(file), .index = *std::move(index)};
  }

  static ArchiveComparison Compare(Client& client, const Opened& opened,
                                   const ComparisonOptions& options = {}) {
    auto comparison = CompareArchive(client, opened.archive(), options, {});
    EXPECT_THAT(comparison, IsOk());
    return *std::move(comparison);
  }

  static absl::StatusOr<ArchiveImportCounts> Import(Client& client, const Opened& opened,
                                                    const ComparisonOptions& options = {},
                                                    const UploadWatch& watch = {}) {
    return ImportArchive(client, opened.archive(), Compare(client, opened, options), {}, watch);
  }

  static std::int64_t Count(const ArchiveComparison& comparison, files::ArchiveKind kind,
                            ArchiveState state) {
    return comparison.counts[static_cast<std::size_t>(kind)][static_cast<std::size_t>(state)];
  }

  static std::int64_t RevisionOf(Client& client) {
    const auto status = client.GetCatalogStatus();
    EXPECT_THAT(status, IsOk());
    return status->catalog_revision();
  }

  // A server on a database of this name.
  std::unique_ptr<server::Server> Start(const std::string& name) const {
    spdlog::set_level(spdlog::level::off);
    server::ServerOptions options;
    options.database = Path(name);
    options.listen = "127.0.0.1:0";
    return server::Server::Start(options).value();  // without it there is nothing to test
  }

  const files::TemporaryFolder folder_;
  const std::unique_ptr<server::Server> from_server_ = Start("from");
  const std::unique_ptr<server::Server> to_server_ = Start("to");
  // Over TCP: gRPC's in-process channel has no buffer, so that a stream whose two sides write at
  // the same time never ends.
  Client from_{{.server = from_server_->address(), .timeout = absl::Minutes(1)}};
  Client to_{{.server = to_server_->address(), .timeout = absl::Minutes(1)}};
};

}  // namespace graspdb::client
