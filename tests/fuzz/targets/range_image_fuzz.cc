// Images of GenICam cameras with the values of their features, and of Video4Linux (Z16): a header
// of fixed size, then the bytes of the image.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "client/cell/sensors/genicam/range_image.h"
#include "client/cell/sensors/video/v4l2_sensor.h"
#include "files/messages/scan_message.h"
#include "tests/fuzz/range_image_input.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

constexpr client::RangeFormat kFormats[] = {client::RangeFormat::kC16, client::RangeFormat::kC32f,
                                            client::RangeFormat::kAbc16,
                                            client::RangeFormat::kAbc32f};
constexpr const char* kModes[] = {"",
                                  "CalibratedC",
                                  "CalibratedABC_Grid",
                                  "DisparityC",
                                  "CalibratedABC_PointCloud",
                                  "UncalibratedC"};
constexpr const char* kUnits[] = {"", "Millimeter", "Inch", "Meter", "Pixel"};

client::RangeGeometry GeometryOf(const RangeImageHeader& header) {
  client::RangeGeometry out;
  out.output_mode = kModes[header.mode % std::size(kModes)];
  out.distance_unit = kUnits[header.unit % std::size(kUnits)];
  for (client::RangeAxis& axis : out.axes) {
    if ((header.flags & 1U) != 0) axis.scale = header.scale;
    axis.offset = header.offset;
    if ((header.flags & 2U) != 0) axis.invalid = header.invalid;
  }
  out.focal_length = header.focal_length;
  out.aspect_ratio = header.aspect_ratio;
  out.principal_u = out.principal_v = header.principal;
  out.baseline_m = header.baseline_m;
  return out;
}

void CheckScan(const files::ScanMessage& scan, std::size_t pixels) {
  const auto points =
      std::visit([](const auto& message) { return files::PointsFromMessage(message); }, scan);
  Require(points.ok() && points->size() == pixels, "a point for each pixel");
  for (const Eigen::Vector3f& point : *points) {
    Require(!(point.z() <= 0), "nothing behind the camera");
  }
  const auto* image = std::get_if<v1::DepthImage>(&scan);
  if (image == nullptr) return;
  Require(image->depth_unit_m() > 0 && image->depth_unit_m() <= 0.1, "a unit of the contract");
}

void ReadZ16(const RangeImageHeader& header, std::span<const char> data) {
  const auto counts = client::CountsOfZ16(
      data, {.width = header.width, .height = header.height, .bytes_per_row = header.row_bytes});
  if (!counts.ok()) return;
  Require(2 * counts->size() <= data.size(), "no more counts than bytes");
}

void Run(std::string_view bytes) {
  RangeImageHeader header;
  if (bytes.size() < sizeof(header)) return;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const std::span<const char> data(bytes.data() + sizeof(header), bytes.size() - sizeof(header));
  ReadZ16(header, data);
  std::optional<recognition::CameraIntrinsics> intrinsics;
  if ((header.flags & 4U) != 0) {
    intrinsics = {.width = header.width, .height = header.height, .fx = 500, .fy = 500};
  }
  const auto scan = client::ScanOfRange({.format = kFormats[header.format % std::size(kFormats)],
                                         .width = header.width,
                                         .height = header.height,
                                         .data = data},
                                        GeometryOf(header), intrinsics);
  if (!scan.ok()) {
    Require(absl::IsFailedPrecondition(scan.status()) || absl::IsDataLoss(scan.status()),
            "a scan or a refusal");
    return;
  }
  CheckScan(*scan,
            static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height));
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
