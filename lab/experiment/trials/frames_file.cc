#include "lab/experiment/trials/frames_file.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <array>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/text/json_keys.h"
#include "program/text/read_file.h"
#include "rendering/mesh_part.h"

namespace graspdb::lab {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

constexpr char kFile[] = "frames.json";
// Maximum file size, bytes.
constexpr std::size_t kLargest = 64U << 20U;
// Maximum deviation of a rotation's rows from unit length and right angles.
constexpr double kRotationTolerance = 1e-3;
// Beyond it no depth camera sees an object, m.
constexpr double kFarthestM = 100;

const Value& FieldOf(const Struct& from, const std::string& name) {
  static const Value none;
  const auto found = from.fields().find(name);
  return found == from.fields().end() ? none : found->second;
}

absl::StatusOr<recognition::Pose> PoseOf(const Value& value) {
  const absl::Status wrong = absl::InvalidArgumentError(
      "T_sensor_mesh must be 4 rows of 4 numbers "
      "that turn and move, or null");
  std::array<double, 16> m{};
  if (value.list_value().values_size() != 4) return wrong;
  for (std::size_t row = 0; row < 4; ++row) {
    const auto& numbers = value.list_value().values(static_cast<int>(row)).list_value();
    if (numbers.values_size() != 4) return wrong;
    for (std::size_t i = 0; i < 4; ++i) {
      m[4 * row + i] = numbers.values(static_cast<int>(i)).number_value();
      if (!std::isfinite(m[4 * row + i])) return wrong;
    }
  }
  recognition::Pose pose = recognition::Pose::Identity();
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      pose.matrix()(row, i) = m[static_cast<std::size_t>(4 * row + i)];
    }
  }
  const double distance = pose.translation().norm();
  if (distance > kFarthestM) {
    return absl::InvalidArgumentError(absl::StrCat("T_sensor_mesh is ", distance,
                                                   " m away; it must be in metres, are these "
                                                   "millimetres?"));
  }
  const Eigen::Matrix3d& r = pose.linear();
  const bool turns = (r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < kRotationTolerance;
  if (!turns || r.determinant() < 0) return wrong;
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  return pose;
}

absl::StatusOr<FrameObject> ObjectOf(const Struct& from, const std::filesystem::path& folder) {
  FrameObject out{.object = FieldOf(from, "object").string_value(), .mesh = {}, .sensor_mesh = {}};
  if (out.object.empty()) return out;
  const std::string& mesh = FieldOf(from, "mesh").string_value();
  if (mesh.empty()) return absl::InvalidArgumentError(absl::StrCat(out.object, " has no mesh"));
  out.mesh = folder / mesh;
  const std::string& unit = FieldOf(from, "meshUnit").string_value();
  if (unit != "m" && unit != "mm") {
    return absl::InvalidArgumentError(absl::StrCat("meshUnit of ", out.object, " must be m or mm"));
  }
  out.unit_m = unit == "mm" ? 0.001 : 1;
  const Value& pose = FieldOf(from, "T_sensor_mesh");
  if (!pose.has_list_value()) return out;
  ASSIGN_OR_RETURN(out.sensor_mesh, PoseOf(pose));
  return out;
}

absl::StatusOr<RealFrame> FrameOf(const Struct& from, const std::filesystem::path& folder) {
  const std::string& path = FieldOf(from, "frame").string_value();
  if (path.empty()) return absl::InvalidArgumentError("\"frame\" must name a point file");
  RealFrame out{.name = std::filesystem::path(path).stem().string(),
                .path = folder / path,
                .sensor = FieldOf(from, "sensor").string_value(),
                .arrangement = FieldOf(from, "arrangement").string_value(),
                .objects = {}};
  for (const Value& value : FieldOf(from, "objects").list_value().values()) {
    auto object = ObjectOf(value.struct_value(), folder);
    if (!object.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(out.name, ": ", object.status().message()));
    }
    out.objects.push_back(*std::move(object));
  }
  return out;
}

// One object is taught from one mesh; answers would be judged on the wrong one otherwise.
absl::Status CheckMeshes(const std::vector<RealFrame>& frames) {
  std::map<std::string, const FrameObject*> known;  // by the id that is taught
  for (const RealFrame& frame : frames) {
    for (const FrameObject& object : frame.objects) {
      if (object.object.empty()) continue;
      const FrameObject& first =
          *known.try_emplace(rendering::ObjectIdOf(object.object), &object).first->second;
      if (first.mesh.lexically_normal() == object.mesh.lexically_normal() &&
          first.unit_m == object.unit_m) {
        continue;
      }
      return absl::InvalidArgumentError(
          absl::StrCat(frame.name, ": ", object.object, " has the mesh ", object.mesh.string(),
                       ", and before another mesh or unit, ", first.mesh.string(),
                       "; give one object one mesh"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

bool HasFrames(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / kFile, ignored);
}

absl::StatusOr<std::vector<RealFrame>> LoadFrames(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kFile;
  if (!HasFrames(folder)) {
    return absl::NotFoundError(absl::StrCat("there is no file ", path.string()));
  }
  ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path, kLargest));
  auto frames = ParseFrames(text, folder);
  if (frames.ok()) return frames;
  return absl::InvalidArgumentError(absl::StrCat(path.string(), ": ", frames.status().message()));
}

absl::StatusOr<std::vector<RealFrame>> ParseFrames(const std::string& text,
                                                   const std::filesystem::path& folder) {
  Value list;
  const auto parsed = google::protobuf::util::JsonStringToMessage(text, &list);
  if (!parsed.ok() || !list.has_list_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("it must be a JSON array of frames ", std::string(parsed.message())));
  }
  RETURN_IF_ERROR(CheckJsonKeys(text));
  std::vector<RealFrame> out;
  for (const Value& value : list.list_value().values()) {
    ASSIGN_OR_RETURN(auto frame, FrameOf(value.struct_value(), folder));
    out.push_back(std::move(frame));
  }
  RETURN_IF_ERROR(CheckMeshes(out));
  return out;
}

}  // namespace graspdb::lab
