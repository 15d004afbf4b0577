#include "client/cli/base/cache_text.h"

#include <array>
#include <cstddef>

#include "absl/strings/str_format.h"

namespace graspdb::client {
namespace {

constexpr double kBytesPerMib = 1 << 20;
// With a higher miss rate, frames are noticeably slower.
constexpr double kFewMissing = 0.05;
// Above this share of its budget a cache evicts entries; below it, misses are first requests.
constexpr double kFull = 0.9;

double RequestCount(const v1::CacheStatus& cache) {
  return static_cast<double>(cache.hit_count() + cache.miss_count());
}

}  // namespace

v1::CacheStatus Between(const v1::CacheStatus& before, const v1::CacheStatus& after) {
  v1::CacheStatus out = after;
  out.set_hit_count(after.hit_count() - before.hit_count());
  out.set_miss_count(after.miss_count() - before.miss_count());
  return out;
}

std::string BytesText(std::int64_t bytes) {
  constexpr std::array<const char*, 5> kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto size = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; size >= 1024 && unit + 1 < kUnits.size(); ++unit) size /= 1024;
  return absl::StrFormat("%.*f %s", unit == 0 ? 0 : 1, size, kUnits[unit]);
}

std::string MemoryText(const v1::MemoryStatus& memory) {
  const auto mib = [](std::int64_t bytes) { return static_cast<double>(bytes) / kBytesPerMib; };
  return absl::StrFormat("%.0f of %.0f MiB, requests %.0f of %.0f MiB, %d refused",
                         mib(memory.resident_byte_count()), mib(memory.byte_budget()),
                         mib(memory.request_byte_count()), mib(memory.request_byte_budget()),
                         memory.refused_request_count());
}

std::string CacheText(const v1::CacheStatus& cache) {
  const std::string memory =
      absl::StrFormat("%.0f of %.0f MiB", static_cast<double>(cache.byte_count()) / kBytesPerMib,
                      static_cast<double>(cache.byte_budget()) / kBytesPerMib);
  if (RequestCount(cache) == 0) return memory + ", no requests yet";
  return absl::StrFormat("%.1f %% of %.0f found, %s",
                         100 * static_cast<double>(cache.hit_count()) / RequestCount(cache),
                         RequestCount(cache), memory);
}

std::string CacheAdvice(const v1::CacheStatus& models) {
  const auto budget = static_cast<double>(models.byte_budget());
  if (static_cast<double>(models.byte_count()) < kFull * budget) return "";
  if (static_cast<double>(models.miss_count()) <= kFewMissing * RequestCount(models)) return "";
  return "models that are not in memory are fused from their views, some 10 ms each; start the "
         "server with a larger --memory-mib";
}

}  // namespace graspdb::client
