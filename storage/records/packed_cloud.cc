#include "storage/records/packed_cloud.h"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "base/status_macros.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "storage/base/restore_advice.h"

namespace graspdb::storage {
namespace {

// Header: magic and version, number of points, checksum of all the rest; the numbers
// little-endian. One zstd frame follows.
constexpr std::string_view kCloudMagic{"GPC\x01", 4};
constexpr std::size_t kCountOffset = 4;
constexpr std::size_t kChecksumOffset = 8;
constexpr std::size_t kCloudHeaderSize = 12;
constexpr int kCompressionLevel = 3;
// A difference of two coordinates is below 2^23 steps, which is four bytes of seven bits.
constexpr std::size_t kMaxVarintSize = 4;
constexpr std::int32_t kMaxCoordinateSteps = 2'000'000;
// Points that are encoded at once, and the bytes for their coordinates along an axis.
constexpr std::size_t kPointsAtOnce = 256;
constexpr std::size_t kBytesAtOnce = kPointsAtOnce * kMaxVarintSize;

absl::Status DamagedCloud(std::string_view what) {
  return absl::DataLossError("the packed cloud is damaged (" + std::string(what) +
                             "); teach the view again, or " + std::string(kRestoreAdvice));
}

absl::Status InvalidCoordinate() {
  return absl::InvalidArgumentError(
      "a coordinate of the cloud is not finite or farther than 100 m from the sensor; "
      "give points in metres and leave out those without a measurement");
}

// Small differences of either sign become small unsigned numbers.
std::uint32_t ZigZag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}

std::int32_t UnZigZag(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

// The value of std::lround for numbers of less than 2^31, without a call.
std::int32_t Rounded(double number) {
  const auto whole = static_cast<std::int32_t>(number);
  const double rest = number - whole;  // exact
  return whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

float CoordinateOf(std::int32_t steps) { return static_cast<float>(steps * kCloudStep); }

// Writes at most kMaxVarintSize bytes at `out`, and returns their end.
char* WriteVarint(std::uint32_t value, char* out) {
  for (; value >= 0x80; value >>= 7) *out++ = static_cast<char>((value & 0x7f) | 0x80);
  *out++ = static_cast<char>(value);
  return out;
}

// Removes a number from the front of `bytes`; false if there is none of at most four bytes.
bool TakeVarint(std::string_view& bytes, std::uint32_t& value) {
  value = 0;
  for (std::size_t i = 0; i < kMaxVarintSize && i < bytes.size(); ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    value |= static_cast<std::uint32_t>(byte & 0x7f) << (7 * i);
    if ((byte & 0x80) == 0) {
      bytes.remove_prefix(i + 1);
      return true;
    }
  }
  return false;
}

absl::StatusOr<std::string> EncodePlanes(std::span<const CloudPoint> points,
                                         std::vector<CloudPoint>* decoded) {
  if (decoded != nullptr) decoded->resize(points.size());
  std::string raw;
  raw.reserve(points.size() * 5);
  std::array<char, kBytesAtOnce> bytes = {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int32_t previous = 0;
    for (std::size_t begin = 0; begin < points.size(); begin += kPointsAtOnce) {
      char* end = bytes.data();
      const std::size_t until = std::min(begin + kPointsAtOnce, points.size());
      for (std::size_t i = begin; i < until; ++i) {
        const float coordinate = points[i][axis];
        if (!(std::abs(coordinate) <= kMaxCloudCoordinate)) return InvalidCoordinate();  // also NaN
        const std::int32_t steps = Rounded(static_cast<double>(coordinate) / kCloudStep);
        end = WriteVarint(ZigZag(steps - previous), end);
        previous = steps;
        if (decoded != nullptr) (*decoded)[i][axis] = CoordinateOf(steps);
      }
      raw.append(bytes.data(), static_cast<std::size_t>(end - bytes.data()));
    }
  }
  return raw;
}

absl::StatusOr<std::vector<CloudPoint>> DecodePlanes(std::string_view raw, std::size_t count) {
  std::vector<CloudPoint> points(count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int32_t steps = 0;
    for (CloudPoint& point : points) {
      std::uint32_t difference = 0;
      if (!TakeVarint(raw, difference)) return DamagedCloud("a coordinate is cut off");
      steps += UnZigZag(difference);
      if (steps > kMaxCoordinateSteps || steps < -kMaxCoordinateSteps)
        return DamagedCloud("a coordinate is out of range");
      point[axis] = CoordinateOf(steps);
    }
  }
  if (!raw.empty()) return DamagedCloud("there are more bytes than points");
  return points;
}

// The thread's own, null without memory: a new one zeroes a few hundred kilobytes, many times the
// bytes of a view. What it compressed before does not change a frame.
ZSTD_CCtx* Compressor() {
  thread_local std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(nullptr,
                                                                            &ZSTD_freeCCtx);
  if (context == nullptr) {
    context.reset(ZSTD_createCCtx());
    if (context == nullptr) return nullptr;
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  }
  return context.get();
}

absl::StatusOr<std::string> Compress(std::string_view raw) {
  ZSTD_CCtx* const context = Compressor();
  if (context == nullptr) return absl::ResourceExhaustedError("no memory to pack the cloud");
  std::string frame(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context, frame.data(), frame.size(), raw.data(), raw.size());
  if (ZSTD_isError(size) != 0) {
    return absl::InternalError(std::string("zstd cannot pack the cloud: ") +
                               ZSTD_getErrorName(size));
  }
  frame.resize(size);
  return frame;
}

}  // namespace

absl::StatusOr<std::string> PackCloud(std::span<const CloudPoint> points,
                                      std::vector<CloudPoint>* unpacked) {
  if (points.size() > kMaxCloudPoints) {
    return absl::InvalidArgumentError(
        "the cloud has more than 10 million points; give the region of interest only");
  }
  ASSIGN_OR_RETURN(auto raw, EncodePlanes(points, unpacked));
  ASSIGN_OR_RETURN(auto frame, Compress(raw));
  std::string packed(kCloudMagic);
  packed += ToLittleEndian(static_cast<std::uint32_t>(points.size()));
  packed += ToLittleEndian(Crc32c(frame, Crc32c(packed)));
  return packed + frame;
}

absl::StatusOr<std::vector<CloudPoint>> UnpackCloud(std::string_view packed) {
  if (packed.size() < kCloudHeaderSize) return DamagedCloud("it is shorter than its header");
  if (!packed.starts_with(kCloudMagic)) return DamagedCloud("it has an unknown format or version");
  const std::size_t count = FromLittleEndian(packed.substr(kCountOffset, kUint32Bytes));
  if (count > kMaxCloudPoints) return DamagedCloud("it has too many points");
  const std::string_view frame = packed.substr(kCloudHeaderSize);
  if (Crc32c(frame, Crc32c(packed.substr(0, kChecksumOffset))) !=
      FromLittleEndian(packed.substr(kChecksumOffset, kUint32Bytes))) {
    return DamagedCloud("its checksum does not match");
  }
  // The checksum detects accidents; the checks below also detect malice.
  const unsigned long long raw_size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (raw_size == ZSTD_CONTENTSIZE_ERROR || raw_size == ZSTD_CONTENTSIZE_UNKNOWN ||
      raw_size < 3 * count || raw_size > 3 * kMaxVarintSize * count) {
    return DamagedCloud("its size does not fit its points");
  }
  std::string raw(raw_size, '\0');
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), frame.data(), frame.size());
  if (ZSTD_isError(size) != 0 || size != raw.size()) return DamagedCloud("zstd cannot unpack it");
  return DecodePlanes(raw, count);
}

}  // namespace graspdb::storage
