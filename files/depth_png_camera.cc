// The sidecar of depth images, see depth_png.h.
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "files/atomic_file.h"
#include "files/depth_png.h"
#include "files/json_object.h"

namespace graspdb::client {
namespace {

// Reads the numbers of the document and keeps the first error.
class Numbers {
 public:
  explicit Numbers(const google::protobuf::Struct& document) : document_(document) {}

  double Required(const std::string& key) {
    const std::optional<double> number = Find(key);
    if (!number) SetError(key, "is missing or not a number");
    return number.value_or(0);
  }
  double Positive(const std::string& key, std::optional<double> otherwise = std::nullopt) {
    if (otherwise && !document_.fields().contains(key)) return *otherwise;
    const double number = Required(key);
    if (!(number > 0)) SetError(key, "is not above 0");
    return number;
  }
  int Pixels(const std::string& key) {
    const double number = Positive(key);
    if (number == std::floor(number) && number < 65536) return static_cast<int>(number);
    SetError(key, "is not a number of pixels");
    return 0;
  }
  const std::string& error_text() const { return error_text_; }

 private:
  std::optional<double> Find(const std::string& key) const {
    const auto field = document_.fields().find(key);
    if (field == document_.fields().end() || !field->second.has_number_value() ||
        !std::isfinite(field->second.number_value())) {
      return std::nullopt;
    }
    return field->second.number_value();
  }
  void SetError(const std::string& key, const std::string& what) {
    if (error_text_.empty()) error_text_ = absl::StrCat("\"", key, "\" ", what);
  }

  const google::protobuf::Struct& document_;
  std::string error_text_;
};

}  // namespace

absl::StatusOr<DepthPngCamera> ReadIntrinsics(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(
        absl::StrCat(path.string(),
                     " does not exist; write width, height, fx, fy, cx, cy (pixels) "
                     "and depthUnitM of the camera into it, as JSON"));
  }
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  google::protobuf::Struct document;
  if (!google::protobuf::util::JsonStringToMessage(text, &document).ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is not a JSON object; correct the file"));
  }
  Numbers numbers(document);
  DepthPngCamera camera;
  recognition::CameraIntrinsics& k = camera.intrinsics;
  k.width = numbers.Pixels("width");
  k.height = numbers.Pixels("height");
  k.fx = numbers.Positive("fx");
  k.fy = numbers.Positive("fy");
  k.cx = numbers.Required("cx");
  k.cy = numbers.Required("cy");
  // The contract's own name is accepted, as elsewhere in JSON: without it counts are millimetres.
  const bool is_snake_case = document.fields().contains("depth_unit_m");
  camera.depth_unit_m = numbers.Positive(is_snake_case ? "depth_unit_m" : "depthUnitM", 0.001);
  if (numbers.error_text().empty()) return camera;
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), ": ", numbers.error_text(), "; correct the file"));
}

absl::Status WriteIntrinsics(const std::filesystem::path& path, const DepthPngCamera& camera) {
  google::protobuf::Struct document;
  const recognition::CameraIntrinsics& k = camera.intrinsics;
  JsonObject(&document).Set(Json("width", k.width), Json("height", k.height), Json("fx", k.fx),
                            Json("fy", k.fy), Json("cx", k.cx), Json("cy", k.cy),
                            Json("depthUnitM", camera.depth_unit_m));
  const absl::StatusOr<std::string> text = PrintDocument(document, JsonLayout::kIndented);
  if (!text.ok()) return text.status();
  return WriteFileAtomically(path, *text, Durability::kProcessCrash);
}

}  // namespace graspdb::client
