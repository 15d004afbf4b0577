#include "tests/faults/sample_views.h"

#include <cmath>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "recognition/base/types.h"

namespace graspdb::faults {
namespace {

constexpr int kContents = 24;
constexpr float kSensorHeightM = 0.6F;

// Points of a part with a ridge, in the sensor's frame: another shape for each number.
recognition::Points Ridge(int number) {
  constexpr float kStepM = 0.0015F;
  const auto n = static_cast<float>(number);
  const int columns = 60 + 2 * number;
  const int rows = 50 + 5 * (number % 5);
  const float height = 0.01F + 0.002F * static_cast<float>(number % 7);
  // Noise, so that the packed cloud is large enough for a blob file (4 KiB).
  std::minstd_rand random(static_cast<unsigned>(number));
  std::uniform_real_distribution<float> noise(-0.0005F, 0.0005F);
  recognition::Points out;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const float x =
          kStepM * (static_cast<float>(column) - std::floor(0.5F * static_cast<float>(columns)));
      const float y =
          kStepM * (static_cast<float>(row) - std::floor(0.5F * static_cast<float>(rows)));
      const float z = 0.01F + height * std::abs(std::sin((20.0F + 3.0F * n) * x)) + 0.3F * y;
      out.emplace_back(x + noise(random), noise(random) - y, kSensorHeightM - z + noise(random));
    }
  }
  return out;
}

// Of GetView, without what differs between views of one content.
std::string StoredForm(v1::View view) {
  view.clear_name();
  view.clear_create_time();
  return view.SerializeAsString();
}

}  // namespace

SampleViews::SampleViews() {
  recognition::Pose world_sensor = recognition::Pose::Identity();  // looks down
  world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  world_sensor.translation().z() = kSensorHeightM;
  for (int i = 0; i < kContents; ++i) {
    Content& content = contents_.emplace_back();
    content.stable_pose = absl::StrCat("objects/ridge-", i, "/stablePoses/up");
    *content.view.mutable_cloud() = files::CloudMessage(Ridge(i), 0);
    content.view.set_segmented(true);
    *content.view.mutable_sensor_pose() = files::ToMessage(world_sensor);
    *content.view.mutable_object_pose() = files::ToMessage(recognition::Pose::Identity());
  }
}

const std::string& SampleViews::StablePoseOf(int content) const {
  return contents_[static_cast<std::size_t>(content)].stable_pose;
}

v1::UploadViewsRequest SampleViews::Request(int content, const std::string& view_id) const {
  v1::UploadViewsRequest out;
  out.set_parent(StablePoseOf(content));
  out.set_view_id(view_id);
  *out.mutable_view() = contents_[static_cast<std::size_t>(content)].view;
  return out;
}

const v1::RecognizeRequest& SampleViews::Scan(int content) const {
  return contents_[static_cast<std::size_t>(content)].scan;
}

absl::Status SampleViews::Prepare(client::Client& client) const {
  for (const Content& content : contents_) {
    v1::CreateObjectRequest object;
    object.set_object_id(content.stable_pose.substr(8, content.stable_pose.find('/', 8) - 8));
    const auto made = client.CreateObject(object);
    if (!made.ok()) return made.status();
    v1::CreateStablePoseRequest pose;
    pose.set_parent(made->name());
    pose.set_stable_pose_id("up");
    if (auto posed = client.CreateStablePose(pose); !posed.ok()) return posed.status();
  }
  return absl::OkStatus();
}

absl::Status SampleViews::LearnStored(client::Client& client) {
  for (int i = 0; i < count(); ++i) {
    const v1::UploadViewsRequest request = Request(i, absl::StrCat("reference-", i));
    if (absl::Status taught = TeachOne(client, request); !taught.ok()) return taught;
    const auto view = client.GetView(absl::StrCat(request.parent(), "/views/", request.view_id()));
    if (!view.ok()) return view.status();
    Content& content = contents_[static_cast<std::size_t>(i)];
    content.stored = StoredForm(*view);
    *content.scan.mutable_cloud() = view->cloud();
    *content.scan.mutable_sensor_pose() = view->sensor_pose();
    content.scan.set_segmented(true);
  }
  return absl::OkStatus();
}

bool SampleViews::IsStored(const v1::View& view, int content) const {
  return StoredForm(view) == contents_[static_cast<std::size_t>(content)].stored;
}

absl::Status TeachOne(client::Client& client, const v1::UploadViewsRequest& view) {
  bool sent = false;
  return client
      .UploadViews([&](v1::UploadViewsRequest* request) {
        *request = view;
        return !std::exchange(sent, true);
      })
      .status();
}

}  // namespace graspdb::faults
