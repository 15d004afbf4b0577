#include "files/depth/lens.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::files {
namespace {

using Eigen::Vector2d;

constexpr int kMaxLensIterations = 200;
// Focal lengths: far below a hundredth of a pixel.
constexpr double kExact = 1e-7;
constexpr char kLensAdvice[] =
    "; use the rectified (undistorted) depth image with its own camera, or send a point cloud";

bool Contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

absl::Status BadLens(const CameraEntry& entry, std::string_view what) {
  return absl::InvalidArgumentError(
      absl::StrCat("\"", entry.path, "\" ", std::string(what), kLensAdvice));
}

// Brown's model with OpenCV's divisor.
Vector2d Distorted(const Lens& lens, const Vector2d& p) {
  const auto& c = lens.coefficients;
  const double r2 = p.squaredNorm();
  const double radial =
      (1 + r2 * (c[0] + r2 * (c[1] + r2 * c[4]))) / (1 + r2 * (c[5] + r2 * (c[6] + r2 * c[7])));
  const double xy = 2 * p.x() * p.y();
  return radial * p + Vector2d(c[2] * xy + c[3] * (r2 + 2 * p.x() * p.x()),
                               c[3] * xy + c[2] * (r2 + 2 * p.y() * p.y()));
}

// Index into Lens::coefficients of a scalar key, -1 for others.
int CoefficientOf(std::string_view name) {
  constexpr std::array<std::string_view, 8> kNames = {"k1", "k2", "p1", "p2",
                                                      "k3", "k4", "k5", "k6"};
  const auto found = std::ranges::find(kNames, name);
  return found == kNames.end() ? -1 : static_cast<int>(found - kNames.begin());
}

bool IsCoefficientList(std::string_view name) {
  return name == "d" || name == "coeffs" || Contains(name, "coef") ||
         (Contains(name, "dist") && !Contains(name, "distance"));
}

// Keys of lenses that have no place in Lens.
bool IsOtherLens(std::string_view name) {
  const bool is_numbered = name.size() == 2 && name[1] >= '0' && name[1] <= '9' &&
                           (name[0] == 'k' || name[0] == 'p' || name[0] == 's');
  return is_numbered || Contains(name, "skew") || Contains(name, "radial") ||
         Contains(name, "tangential") || Contains(name, "lens") || Contains(name, "fisheye");
}

bool IsZero(const std::vector<double>& numbers) {
  return std::ranges::all_of(numbers, [](double number) { return number == 0; });
}

// What the texts of a camera file say about its lens.
struct LensModel {
  // Brown's. RealSense's "inverse Brown-Conrady" is the same in spite of its name: undistortPoints
  // gives what its own deprojection does (github.com/IntelRealSense/librealsense/issues/13824).
  bool is_known = false;
  bool is_other = false;
};

absl::StatusOr<LensModel> ModelOf(const std::vector<CameraEntry>& entries) {
  LensModel out;
  for (const CameraEntry& entry : entries) {
    const auto names = {"model", "type", "projection", "lens", "dist"};
    const auto is_part = [&](const char* name) { return Contains(entry.name, name); };
    if (entry.text.empty() || std::ranges::none_of(names, is_part)) continue;
    const std::string text = absl::AsciiStrToLower(entry.text);
    for (const char* other : {"fisheye", "fish_eye", "equidistant", "kannala", "theta", "omni"}) {
      if (Contains(text, other)) return BadLens(entry, "is not the model of a pinhole camera");
    }
    if (!Contains(entry.name, "model")) continue;
    const auto is_known = [&](const char* name) { return Contains(text, name); };
    const auto known = {"brown", "plumb", "rational", "opencv", "radtan", "radial"};
    out.is_known = out.is_known || std::ranges::any_of(known, is_known);
    const bool is_of_lens = Contains(entry.name, "dist") || Contains(entry.name, "camera");
    out.is_other = out.is_other || Contains(text, "modified") ||
                   (is_of_lens && std::ranges::none_of(known, is_known));
  }
  return out;
}

absl::Status SetCoefficient(const CameraEntry& entry, std::size_t index, double value, Lens* lens) {
  double& coefficient = lens->coefficients[index];
  if (coefficient != 0 && coefficient != value) {
    return BadLens(entry, "contradicts another distortion of the file");
  }
  coefficient = value;
  return absl::OkStatus();
}

bool IsKnownList(const std::vector<double>& numbers) {
  constexpr std::size_t kCoefficients = 8;
  return numbers.size() >= 4 && (numbers.size() <= kCoefficients ||
                                 IsZero({numbers.begin() + kCoefficients, numbers.end()}));
}

absl::Status AddCoefficients(const CameraEntry& entry, const LensModel& model, Lens* lens) {
  if (const int index = CoefficientOf(entry.name); index >= 0 && entry.numbers.size() == 1) {
    return SetCoefficient(entry, static_cast<std::size_t>(index), entry.numbers[0], lens);
  }
  const bool is_list = IsCoefficientList(entry.name);
  if (!is_list && !IsOtherLens(entry.name)) return absl::OkStatus();
  if (!Contains(entry.name, "model") &&
      entry.text.find_first_of("123456789") != std::string::npos) {
    return BadLens(entry, "is a text; write a list of numbers");
  }
  if (IsZero(entry.numbers)) return absl::OkStatus();
  if (!is_list || !IsKnownList(entry.numbers)) {
    return BadLens(entry, "is a distortion that is not known here, and not 0");
  }
  if (entry.name == "coeffs" && !model.is_known) {
    return BadLens(entry, "needs the \"model\" of its distortion");
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(entry.numbers.size(), 8); ++i) {
    RETURN_IF_ERROR(SetCoefficient(entry, i, entry.numbers[i], lens));
  }
  return absl::OkStatus();
}

}  // namespace

std::optional<Vector2d> Undistorted(const Lens& lens, const Vector2d& place) {
  // As OpenCV's undistortPoints: the displacement at the last guess is taken from the place.
  Vector2d guess = place;
  for (int step = 0; step < kMaxLensIterations; ++step) {
    const Vector2d error = Distorted(lens, guess) - place;
    if (!error.allFinite()) break;
    if (error.norm() < kExact) return guess;
    guess -= error;
  }
  return std::nullopt;
}

absl::StatusOr<Lens> LensOf(const std::vector<CameraEntry>& entries) {
  ASSIGN_OR_RETURN(const LensModel model, ModelOf(entries));
  Lens lens;
  for (const CameraEntry& entry : entries) {
    RETURN_IF_ERROR(AddCoefficients(entry, model, &lens));
  }
  if (!lens.is_distorted() || !model.is_other) return lens;
  return absl::InvalidArgumentError(
      absl::StrCat("the model of its distortion is not known here", kLensAdvice));
}

}  // namespace graspdb::files
