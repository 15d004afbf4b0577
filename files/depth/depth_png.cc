#include "files/depth/depth_png.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "files/messages/scan_message.h"
#include "program/text/read_file.h"

namespace graspdb::files {
namespace {

constexpr std::uint32_t kLongestSide = 8192;     // pixels; more than any depth camera has
constexpr std::size_t kMaxPngBytes = 256 << 20;  // of 128 MiB of pixels
constexpr int kSignatureBytes = 8;
constexpr std::size_t kPixelBytes = 2;
static_assert(std::endian::native == std::endian::little, "counts are little-endian");

// libpng calls longjmp on errors. Objects that it must not jump over are kept here, and the
// functions that it leaves have no objects with destructors.
struct PngFile {
  png_structp png = nullptr;
  png_infop info = nullptr;
  bool writes = false;
  std::string_view unread;
  std::string written;
  std::string trouble;

  PngFile() = default;
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;
  ~PngFile() {
    if (writes) {
      png_destroy_write_struct(&png, &info);
    } else {
      png_destroy_read_struct(&png, &info, nullptr);
    }
  }
};

void OnError(png_structp png, png_const_charp what) {
  static_cast<PngFile*>(png_get_error_ptr(png))->trouble = what;
  png_longjmp(png, 1);
}

void OnWarning(png_structp /*png*/, png_const_charp /*what*/) {}

void OnRead(png_structp png, png_bytep out, std::size_t size) {
  auto* const file = static_cast<PngFile*>(png_get_io_ptr(png));
  if (file->unread.size() < size) png_error(png, "the file is cut short");
  std::memcpy(out, file->unread.data(), size);
  file->unread.remove_prefix(size);
}

void OnWrite(png_structp png, png_bytep bytes, std::size_t size) {
  static_cast<PngFile*>(png_get_io_ptr(png))
      ->written.append(reinterpret_cast<const char*>(bytes), size);
}

void OnFlush(png_structp /*png*/) {}

bool ReadHeader(PngFile& file) {
  file.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &file, OnError, OnWarning);
  if (file.png != nullptr) file.info = png_create_info_struct(file.png);
  if (file.info == nullptr) {
    file.trouble = "out of memory";
    return false;
  }
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_user_limits(file.png, kLongestSide, kLongestSide);
  png_set_read_fn(file.png, &file, OnRead);
  png_read_info(file.png, file.info);
  return true;
}

bool ReadRows(PngFile& file, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_interlace_handling(file.png);
  png_set_swap(file.png);  // PNG has the high byte first
  png_read_image(file.png, rows.data());
  png_read_end(file.png, nullptr);
  return true;
}

bool WriteAll(PngFile& file, std::uint32_t width, std::uint32_t height,
              std::vector<png_bytep>& rows) {
  file.writes = true;
  file.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &file, OnError, OnWarning);
  if (file.png != nullptr) file.info = png_create_info_struct(file.png);
  if (file.info == nullptr) return false;
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_write_fn(file.png, &file, OnWrite, OnFlush);
  png_set_IHDR(file.png, file.info, width, height, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(file.png, file.info);
  png_set_swap(file.png);
  png_write_image(file.png, rows.data());
  png_write_end(file.png, nullptr);
  return true;
}

std::vector<png_bytep> RowsOf(std::string& bytes, std::size_t width, std::size_t height) {
  std::vector<png_bytep> rows;
  rows.reserve(height);
  for (std::size_t v = 0; v < height; ++v) {
    rows.push_back(reinterpret_cast<png_bytep>(bytes.data() + v * width * kPixelBytes));
  }
  return rows;
}

absl::Status Bad(const std::filesystem::path& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(path.string(), " ", what));
}

// Sum of the differences of neighbours in a row, both measured, and their number.
struct DepthSteps {
  double sum = 0;
  double swapped_sum = 0;  // with the two bytes of each count swapped
  std::size_t pairs = 0;
};

DepthSteps StepsOf(const std::vector<std::uint16_t>& counts, std::size_t width) {
  const auto swapped = [](int count) { return (count & 0xFF) << 8 | count >> 8; };
  DepthSteps out;
  for (std::size_t i = 1; i < counts.size(); ++i) {
    const int a = counts[i - 1];
    const int b = counts[i];
    if (i % width == 0 || a == 0 || b == 0) continue;
    out.sum += std::abs(a - b);
    out.swapped_sum += std::abs(swapped(a) - swapped(b));
    ++out.pairs;
  }
  return out;
}

// Surfaces are smooth. Where a program forgot that PNG has the high byte first, a step of one count
// is one of 256.
bool IsByteSwapped(const std::vector<std::uint16_t>& counts, std::size_t width) {
  constexpr std::size_t kEnoughPairs = 1000;
  constexpr double kSmoother = 4;
  const DepthSteps steps = StepsOf(counts, width);
  return steps.pairs >= kEnoughPairs && steps.sum > kSmoother * steps.swapped_sum;
}

// Little-endian counts, 0 where nothing was measured.
absl::Status KeepMeasurements(const std::filesystem::path& path, const DepthPngCamera& camera,
                              std::string* data) {
  std::vector<std::uint16_t> counts(data->size() / kPixelBytes);
  std::memcpy(counts.data(), data->data(), data->size());
  for (std::uint16_t& count : counts) {
    const auto& invalid = camera.invalid_counts;
    if (count == kNoCount || std::ranges::find(invalid, count) != invalid.end()) count = 0;
  }
  if (IsByteSwapped(counts, static_cast<std::size_t>(camera.intrinsics.width))) {
    return Bad(path,
               "has counts that are smooth only with their two bytes swapped: PNG has the "
               "high byte first; save the image again, as 16-bit grey, not as 8-bit grey "
               "times 256");
  }
  std::memcpy(data->data(), counts.data(), data->size());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::DepthImage> ReadDepthPng(const std::filesystem::path& path,
                                            const DepthPngCamera& camera) {
  ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, kMaxPngBytes));
  PngFile file;
  file.unread = bytes;
  if (bytes.size() < kSignatureBytes ||
      png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, kSignatureBytes) != 0) {
    return Bad(path, "is not a PNG file; name the depth image of a camera");
  }
  if (!ReadHeader(file)) return Bad(path, absl::StrCat("is damaged (", file.trouble, ")"));
  if (png_get_bit_depth(file.png, file.info) != 16 ||
      png_get_color_type(file.png, file.info) != PNG_COLOR_TYPE_GRAY) {
    const int channels = png_get_channels(file.png, file.info);
    return Bad(path,
               absl::StrCat("has ", channels, channels == 1 ? " channel of " : " channels of ",
                            int{png_get_bit_depth(file.png, file.info)},
                            " bits, and a depth image one channel of 16 bits; save depths as "
                            "16-bit grey, not as a picture"));
  }
  const std::size_t width = png_get_image_width(file.png, file.info);
  const std::size_t height = png_get_image_height(file.png, file.info);
  const recognition::CameraIntrinsics& k = camera.intrinsics;
  if (static_cast<int>(width) != k.width || static_cast<int>(height) != k.height) {
    return Bad(path, absl::StrCat("has ", width, " x ", height, " pixels, and its camera ", k.width,
                                  " x ", k.height, "; correct the intrinsics beside it"));
  }
  v1::DepthImage image;
  *image.mutable_intrinsics() = ToMessage(k);
  image.set_depth_unit_m(camera.depth_unit_m);
  image.mutable_data()->resize(kPixelBytes * width * height);
  std::vector<png_bytep> rows = RowsOf(*image.mutable_data(), width, height);
  if (!ReadRows(file, rows)) return Bad(path, absl::StrCat("is damaged (", file.trouble, ")"));
  RETURN_IF_ERROR(KeepMeasurements(path, camera, image.mutable_data()));
  return image;
}

absl::Status WriteDepthPng(const std::filesystem::path& path, const v1::DepthImage& image) {
  RETURN_IF_ERROR(CountsFromMessage(image).status());
  const v1::CameraIntrinsics& camera = image.intrinsics();
  std::string bytes = image.data();
  std::vector<png_bytep> rows = RowsOf(bytes, static_cast<std::size_t>(camera.width()),
                                       static_cast<std::size_t>(camera.height()));
  PngFile file;
  if (!WriteAll(file, static_cast<std::uint32_t>(camera.width()),
                static_cast<std::uint32_t>(camera.height()), rows)) {
    return absl::InternalError(
        absl::StrCat("cannot encode ", path.string(), " as PNG: ", file.trouble));
  }
  return WriteFileAtomically(path, file.written, Durability::kProcessCrash);
}

}  // namespace graspdb::files
