#include "client/cell/sensors/kinect/fakenect_recording.h"

#include <google/protobuf/struct.pb.h>

#include <cmath>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "files/base/atomic_file.h"
#include "files/base/json_object.h"
#include "rendering/scene_file.h"
#include "rendering/simulation.h"

namespace graspdb::client {
namespace {

constexpr char kIndexFile[] = "INDEX.txt";
constexpr double kFramesPerSecond = 30;
constexpr double kTicksPerSecond = 60e6;    // of the Kinect's clock
constexpr double kFirstSecond = 1'000'000;  // arbitrary; 0 would mean no time
constexpr KinectV1Calibration kCalibration;
constexpr std::size_t kRawPixels = std::size_t{kKinectV1Width} * kKinectV1Height;

// libfreenect uses centimetres.
absl::StatusOr<std::string> DeviceJson() {
  google::protobuf::Struct document;
  files::JsonObject device(&document);
  device.Set(files::Json("const_shift", kCalibration.const_shift));
  files::JsonObject registration = device.Object("reg_info");
  registration.Object("zero_plane_info")
      .Set(files::Json("dcmos_emitter_distance", 100 * kCalibration.baseline_m),
           files::Json("dcmos_rcmos_distance", 2.3),
           files::Json("reference_distance", 100 * kCalibration.reference_distance_m),
           files::Json("reference_pixel_size", 100 * kCalibration.reference_pixel_m));
  registration.Object("pad_info")
      .Set(files::Json("start_lines", 0), files::Json("end_lines", 0),
           files::Json("cropping_lines", 0));
  return files::PrintDocument(document, files::JsonLayout::kIndented);
}

std::string PgmOf(const std::vector<std::uint16_t>& raw) {
  std::string bytes = absl::StrCat("P5 ", kKinectV1Width, " ", kKinectV1Height, " 65535\n");
  bytes.reserve(bytes.size() + 2 * raw.size());
  for (const std::uint16_t value : raw) {  // fakenect's byte order, not PGM's
    bytes.push_back(static_cast<char>(value & 0xFFU));
    bytes.push_back(static_cast<char>(value >> 8U));
  }
  return bytes;
}

}  // namespace

absl::StatusOr<FakenectRecording> FakenectRecording::Create(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder / kIndexFile, error)) {
    return absl::AlreadyExistsError(
        absl::StrCat(folder.string(), " contains a recording; choose another folder or remove it"));
  }
  ASSIGN_OR_RETURN(const std::string device, DeviceJson());
  RETURN_IF_ERROR(
      files::WriteFileAtomically(folder / "device.json", device, files::Durability::kProcessCrash));
  return FakenectRecording(folder);
}

std::string FakenectRecording::NextName() {
  const double seconds = static_cast<double>(frames_++) / kFramesPerSecond;
  const auto ticks = static_cast<std::uint32_t>(
      static_cast<std::int64_t>(seconds * kTicksPerSecond));  // wraps like the camera's clock
  std::string name = absl::StrFormat("d-%f-%u.pgm", kFirstSecond + seconds, ticks);
  absl::StrAppend(&index_, name, "\n");
  return name;
}

absl::Status FakenectRecording::Show(const rendering::DepthFrame& frame, absl::Duration duration) {
  if (frame.width != kKinectV1Width || frame.height != kKinectV1Height) {
    return absl::InvalidArgumentError(
        absl::StrCat("a Kinect v1 has 640 x 480 pixels and the frame ", frame.width, " x ",
                     frame.height, "; render it with SimulatedKinectV1"));
  }
  std::vector<std::uint16_t> raw;
  raw.reserve(frame.depth_m.size());
  for (const float z : frame.depth_m) {
    raw.push_back(RawOfDepth(kCalibration, static_cast<double>(z)));
  }
  return ShowRaw(raw, duration);
}

absl::Status FakenectRecording::ShowRaw(const std::vector<std::uint16_t>& raw,
                                        absl::Duration duration) {
  if (raw.size() != kRawPixels) {
    return absl::InvalidArgumentError(
        absl::StrCat("a Kinect v1 has 640 x 480 pixels and not ", raw.size()));
  }
  const std::string first = NextName();
  RETURN_IF_ERROR(
      files::WriteFileAtomically(folder_ / first, PgmOf(raw), files::Durability::kProcessCrash));
  const long long count = std::llround(absl::ToDoubleSeconds(duration) * kFramesPerSecond);
  for (long long frame = 1; frame < count; ++frame) {
    const std::filesystem::path name = folder_ / NextName();
    std::error_code error;
    std::filesystem::remove(name, error);
    std::filesystem::create_symlink(first, name, error);
    if (error) {
      return absl::UnavailableError(
          absl::StrCat("cannot write ", name.string(), ": ", error.message()));
    }
  }
  return absl::OkStatus();
}

absl::Status FakenectRecording::PullOut() {
  return files::WriteFileAtomically(folder_ / NextName(), "", files::Durability::kProcessCrash);
}

absl::Status FakenectRecording::Finish() {
  return files::WriteFileAtomically(folder_ / kIndexFile, index_, files::Durability::kProcessCrash);
}

absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<rendering::Workpiece>& parts,
                                     const std::vector<rendering::PlannedCapture>& plan,
                                     absl::Duration duration) {
  if (plan.empty()) return absl::InvalidArgumentError("a recording needs at least one scene");
  ASSIGN_OR_RETURN(const rendering::DepthCamera camera,
                   rendering::DepthCamera::Create(SimulatedKinectV1()));
  ASSIGN_OR_RETURN(FakenectRecording recording, FakenectRecording::Create(folder));
  for (const rendering::PlannedCapture& scene : plan) {
    RETURN_IF_ERROR(rendering::CheckPlacements(parts, scene));
    ASSIGN_OR_RETURN(const rendering::DepthFrame frame,
                     camera.Render(rendering::SceneOf(parts, scene, /*with_table=*/true),
                                   scene.world_sensor, scene.seed));
    RETURN_IF_ERROR(recording.Show(frame, duration));
  }
  RETURN_IF_ERROR(rendering::WriteScenes(folder, parts, plan));
  return recording.Finish();
}

}  // namespace graspdb::client
