// Depth images and their sidecars with the camera: an input that begins with "{" is a sidecar,
// every other one a PNG file, whose chunk checksums are corrected.
#include <zlib.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "files/depth/depth_png.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {
namespace {

constexpr std::size_t kSignatureBytes = 8;
constexpr std::size_t kChunkStartBytes = 8;  // length and type
constexpr std::size_t kChecksumBytes = 4;
constexpr std::size_t kWidthAt = 16;
constexpr std::size_t kHeightAt = 20;
// Limit on the size, since larger images only cost time.
constexpr std::uint64_t kMaxPixels = 1 << 18;

const ScratchFolder& Folder() {
  static const ScratchFolder folder;
  return folder;
}

std::uint32_t GetUint32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

void FixChecksums(std::string& bytes) {
  std::size_t at = kSignatureBytes;
  while (at + kChunkStartBytes + kChecksumBytes <= bytes.size()) {
    const std::size_t length = GetUint32(bytes, at);
    const std::size_t left = bytes.size() - at - kChunkStartBytes - kChecksumBytes;
    if (length > left) return;
    const auto* typed = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    const auto crc = static_cast<std::uint32_t>(crc32(0, typed, static_cast<uInt>(length + 4)));
    at += kChunkStartBytes + length;
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(crc >> (24 - 8 * i));
    at += kChecksumBytes;
  }
}

void ReadSidecar(std::string_view text) {
  const auto camera = files::ReadIntrinsics(Folder().Write(files::kIntrinsicsFile, text));
  if (!camera.ok()) return;
  Require(camera->intrinsics.width > 0 && camera->intrinsics.height > 0, "a size");
  Require(camera->intrinsics.fx > 0 && camera->intrinsics.fy > 0, "a focal length");
  Require(camera->depth_unit_m > 0 && camera->depth_unit_m <= 0.01, "a unit");
  Require(camera->invalid_counts.size() <= 16, "few invalid counts");
  const auto ray = files::Undistorted(camera->lens, {0.3, -0.2});
  Require(!ray || ray->allFinite(), "a ray or none");
}

void ReadPng(std::string bytes) {
  FixChecksums(bytes);
  files::DepthPngCamera camera;
  camera.intrinsics = {.width = 64, .height = 48, .fx = 60, .fy = 60, .cx = 31.5, .cy = 23.5};
  const std::uint64_t width = GetUint32(bytes, kWidthAt);
  const std::uint64_t height = GetUint32(bytes, kHeightAt);
  if (width < kMaxPixels && height < kMaxPixels && width * height <= kMaxPixels) {
    camera.intrinsics.width = static_cast<int>(width);
    camera.intrinsics.height = static_cast<int>(height);
  }
  const auto image = files::ReadDepthPng(Folder().Write("in.png", bytes), camera);
  if (!image.ok()) return;
  const auto pixels = static_cast<std::size_t>(camera.intrinsics.width * camera.intrinsics.height);
  Require(image->data().size() == 2 * pixels, "two bytes a pixel");
  const std::filesystem::path copy = Folder().path() / "out.png";
  Require(files::WriteDepthPng(copy, *image).ok(), "parsed data can be written");
  const auto again = files::ReadDepthPng(copy, camera);
  Require(again.ok() && again->data() == image->data(), "the same image after writing");
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with("{")) {
    graspdb::fuzz::ReadSidecar(bytes);
  } else {
    graspdb::fuzz::ReadPng(std::string(bytes));
  }
  return 0;
}
