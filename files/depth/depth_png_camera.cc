// The sidecar of depth images, see depth_png.h.
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "files/base/json_object.h"
#include "files/depth/camera_entries.h"
#include "files/depth/depth_png.h"
#include "files/depth/depth_unit.h"
#include "program/text/json_keys.h"
#include "program/text/read_file.h"

namespace graspdb::files {
namespace {

constexpr std::size_t kMaxSidecarBytes = std::size_t{1} << 16U;
// A camera with a shorter focal length, widths of its image, sees more than 160 degrees.
constexpr double kShortestFocalLength = 0.09;

absl::Status BadKey(const std::string& key, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("\"", key, "\" ", what));
}

// The numbers of a pinhole camera, under the names of any program; keeps the first error.
class CameraNumbers {
 public:
  explicit CameraNumbers(const std::vector<CameraEntry>& entries) : entries_(entries) {
    ReadMatrix();
  }

  // `in_matrix`: index into a camera matrix row by row, where the number may be too.
  double Required(const std::string& key, const std::string& other_key, std::size_t in_matrix) {
    std::optional<double> out;
    if (!matrix_.empty()) out = matrix_[in_matrix];
    for (const CameraEntry& entry : entries_) {
      if (entry.path != key && entry.path != other_key) continue;
      if (entry.numbers.size() != 1) SetError(BadKey(entry.path, "is not a number"));
      const double number = entry.numbers.empty() ? 0 : entry.numbers[0];
      if (out && *out != number) SetError(BadKey(entry.path, "contradicts another key"));
      out = number;
    }
    if (!out) SetError(BadKey(key, "is missing"));
    return out.value_or(0);
  }
  double Positive(const std::string& key, const std::string& other_key, std::size_t in_matrix) {
    const double number = Required(key, other_key, in_matrix);
    if (!(number > 0)) SetError(BadKey(key, "is not above 0"));
    return number;
  }
  int Pixels(const std::string& key) {
    const CameraEntry* entry = Find(key);
    const double number = entry == nullptr || entry->numbers.size() != 1 ? 0 : entry->numbers[0];
    if (number > 0 && number < 65536 && number == std::floor(number)) {
      return static_cast<int>(number);
    }
    SetError(BadKey(key, entry == nullptr ? "is missing" : "is not a number of pixels"));
    return 0;
  }
  void SetError(const absl::Status& error) { error_.Update(error); }
  const absl::Status& error() const { return error_; }

 private:
  const CameraEntry* Find(const std::string& path) const {
    const auto found = std::ranges::find(entries_, path, &CameraEntry::path);
    return found == entries_.end() ? nullptr : &*found;
  }

  // The last row is (0, 0, 1), so the places of the zeros show whether a matrix is row by row, as
  // most programs write it, or column by column, as Open3D does.
  void ReadMatrix() {
    for (const CameraEntry& entry : entries_) {
      const auto is_name = [&](const char* name) { return entry.name == name; };
      if (std::ranges::none_of(std::array{"k", "camk", "cameramatrix", "intrinsicmatrix"},
                               is_name) ||
          entry.numbers.empty()) {
        continue;
      }
      std::vector<double> m = entry.numbers;
      if (m.size() == 9 && m[2] == 0 && m[5] == 0) {
        std::swap(m[1], m[3]);
        std::swap(m[2], m[6]);
        std::swap(m[5], m[7]);
      }
      if (m.size() != 9 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1) {
        SetError(BadKey(entry.path, "is not a camera matrix of 3 x 3 numbers"));
      } else if (m[1] != 0) {
        SetError(BadKey(entry.path, "has a skew; use a rectified depth image with its own camera"));
      } else if (!matrix_.empty() && matrix_ != m) {
        SetError(BadKey(entry.path, "contradicts another key"));
      } else {
        matrix_ = std::move(m);
      }
    }
  }

  const std::vector<CameraEntry>& entries_;
  std::vector<double> matrix_;  // row by row; empty: none
  absl::Status error_;
};

absl::Status CheckCamera(const recognition::CameraIntrinsics& k) {
  if (k.fx < kShortestFocalLength * k.width || k.fy < kShortestFocalLength * k.height) {
    return BadKey("fx",
                  "or \"fy\" is too short for the size of the image; write focal lengths in "
                  "pixels");
  }
  const bool is_unset = k.cx == 0 && k.cy == 0 && k.width > 1 && k.height > 1;
  if (is_unset || k.cx < 0 || k.cy < 0 || k.cx > k.width - 1 || k.cy > k.height - 1) {
    return BadKey("cx",
                  absl::StrCat("or \"cy\" is outside of the image of ", k.width, " x ", k.height,
                               " pixels; write the principal point in pixels of "
                               "this image"));
  }
  return absl::OkStatus();
}

absl::StatusOr<DepthPngCamera> CameraFrom(const std::string& text) {
  google::protobuf::Struct document;
  if (!google::protobuf::util::JsonStringToMessage(text, &document).ok()) {
    return absl::InvalidArgumentError("it is not a JSON object");
  }
  RETURN_IF_ERROR(CheckJsonKeys(text));
  ASSIGN_OR_RETURN(const auto entries, CameraEntriesOf(document));
  CameraNumbers numbers(entries);
  DepthPngCamera camera;
  recognition::CameraIntrinsics& k = camera.intrinsics;
  k.width = numbers.Pixels("width");
  k.height = numbers.Pixels("height");
  k.fx = numbers.Positive("fx", "fx", 0);
  k.fy = numbers.Positive("fy", "fy", 4);
  k.cx = numbers.Required("cx", "ppx", 2);
  k.cy = numbers.Required("cy", "ppy", 5);
  const auto unit = DepthUnitOf(entries);
  const auto invalid = InvalidCountsOf(entries);
  const auto lens = LensOf(entries);
  for (const absl::Status& status :
       {numbers.error(), CheckCamera(k), unit.status(), invalid.status(), lens.status()}) {
    if (!status.ok()) return status;
  }
  camera.depth_unit_m = *unit;
  camera.invalid_counts = *invalid;
  camera.lens = *lens;
  return camera;
}

}  // namespace

absl::StatusOr<DepthPngCamera> ReadIntrinsics(const std::filesystem::path& path) {
  absl::StatusOr<std::string> text = ReadTextFile(path, kMaxSidecarBytes);
  if (absl::IsNotFound(text.status())) {
    return absl::NotFoundError(absl::StrCat(
        path.string(),
        " does not exist; write width, height, fx, fy, cx, cy (pixels) and depthUnitM of the "
        "camera into it, as JSON, or copy the camera.json of a BOP dataset or the "
        "camera_intrinsic.json of Open3D"));
  }
  if (!text.ok()) return text.status();
  absl::StatusOr<DepthPngCamera> camera = CameraFrom(*text);
  if (camera.ok()) return camera;
  const absl::string_view what = camera.status().message();
  return absl::InvalidArgumentError(absl::StrCat(
      path.string(), ": ", what, absl::StrContains(what, "; ") ? "" : "; correct the file"));
}

absl::Status WriteIntrinsics(const std::filesystem::path& path, const DepthPngCamera& camera) {
  google::protobuf::Struct document;
  const recognition::CameraIntrinsics& k = camera.intrinsics;
  JsonObject(&document).Set(Json("width", k.width), Json("height", k.height), Json("fx", k.fx),
                            Json("fy", k.fy), Json("cx", k.cx), Json("cy", k.cy),
                            Json("depthUnitM", camera.depth_unit_m));
  ASSIGN_OR_RETURN(const std::string text, PrintDocument(document, JsonLayout::kIndented));
  return WriteFileAtomically(path, text, Durability::kProcessCrash);
}

}  // namespace graspdb::files
