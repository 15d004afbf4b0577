// Sends one depth image to a graspdb server and prints what stands on the table and how to grasp
// it.
//
// recognize [HOST:PORT]
#include <graspdb/client.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

namespace {

using Vector = std::array<double, 3>;
constexpr double kNowhere = std::numeric_limits<double>::infinity();

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kFocalPx = 300;

// Where a ray enters an upright box of 80 x 50 x 30 mm that stands at the origin.
double BoxDepth(const Vector& eye, const Vector& ray) {
  constexpr double kYaw = 25 * std::numbers::pi / 180;
  const auto turned = [](const Vector& p) -> Vector {
    return {p[0] * std::cos(kYaw) + p[1] * std::sin(kYaw),
            p[1] * std::cos(kYaw) - p[0] * std::sin(kYaw), p[2]};
  };
  constexpr Vector kHalfSize = {0.04, 0.025, 0.015};
  constexpr Vector kMiddle = {0, 0, 0.015};
  const Vector start = turned(eye);
  const Vector step = turned(ray);
  double near = 0;
  double far = kNowhere;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = (kMiddle[i] - kHalfSize[i] - start[i]) / step[i];
    const double b = (kMiddle[i] + kHalfSize[i] - start[i]) / step[i];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near < far ? near : kNowhere;
}

// In the place of a camera, which is 0.45 m before the box and 0.54 m above the table and looks at
// the foot of the box.
graspdb::v1::DepthImage Capture() {
  graspdb::v1::DepthImage image;
  image.mutable_intrinsics()->set_width(kWidth);
  image.mutable_intrinsics()->set_height(kHeight);
  image.mutable_intrinsics()->set_fx(kFocalPx);
  image.mutable_intrinsics()->set_fy(kFocalPx);
  image.mutable_intrinsics()->set_cx((kWidth - 1) / 2.0);
  image.mutable_intrinsics()->set_cy((kHeight - 1) / 2.0);
  const Vector eye = {0, -0.45, 0.54};
  const double length = std::hypot(eye[1], eye[2]);
  const Vector forward = {0, -eye[1] / length, -eye[2] / length};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double down = (v - image.intrinsics().cy()) / kFocalPx;
      const Vector ray = {(u - image.intrinsics().cx()) / kFocalPx, forward[1] + forward[2] * down,
                          forward[2] - forward[1] * down};
      const double table = ray[2] < 0 ? -eye[2] / ray[2] : kNowhere;
      const double depth_m = std::min({table, BoxDepth(eye, ray), 65.0});
      const auto millimetres = static_cast<std::uint16_t>(std::lround(1000 * depth_m));
      image.mutable_data()->push_back(static_cast<char>(millimetres & 0xFF));
      image.mutable_data()->push_back(static_cast<char>(millimetres >> 8));
    }
  }
  return image;
}

}  // namespace

int main(int argc, char** argv) {
  graspdb::client::Client client({.server = argc > 1 ? argv[1] : "127.0.0.1:50051"});
  graspdb::v1::RecognizeRequest request;
  *request.mutable_depth_image() = Capture();
  const auto answer = client.Recognize(request);
  if (!answer.ok()) {
    std::fprintf(stderr, "%s\n", answer.status().ToString().c_str());
    return 1;
  }
  for (const graspdb::v1::Detection& detection : answer->detections()) {
    if (detection.status() != graspdb::v1::OK) continue;
    const graspdb::v1::Vector3& at = detection.refined_pose().position();
    std::printf("%s (%.2f) at %.3f %.3f %.3f m, %d grasps\n", detection.object().c_str(),
                detection.score(), at.x(), at.y(), at.z(), detection.grasps_size());
  }
  return answer->status() == graspdb::v1::OK ? 0 : 1;
}
