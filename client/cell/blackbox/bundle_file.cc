#include "client/cell/blackbox/bundle_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <system_error>

namespace graspdb::client {
namespace {

constexpr std::string_view kBundleMagic = "GBB";
constexpr char kVersion = 1;
constexpr std::size_t kBundleHeaderBytes = 4;
constexpr std::uintmax_t kMaxBundleBytes = std::numeric_limits<int>::max();  // of a message

absl::Status NoBundle(const std::filesystem::path& path) {
  return absl::DataLossError(path.string() + " is not a bundle, or truncated; leave it out");
}

}  // namespace

absl::StatusOr<std::string> BundleBytes(const v1::Bundle& bundle) {
  std::string out(kBundleMagic);
  out += kVersion;
  if (bundle.AppendToString(&out)) return out;
  return absl::ResourceExhaustedError("the bundle exceeds the maximum message size");
}

absl::StatusOr<v1::Bundle> ReadBundle(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t length = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    return absl::NotFoundError("cannot read " + path.string() + "; is it there?");
  }
  if (length > kMaxBundleBytes) return NoBundle(path);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.size() < kBundleHeaderBytes || !bytes.starts_with(kBundleMagic)) return NoBundle(path);
  if (bytes[kBundleMagic.size()] != kVersion) {
    return absl::FailedPreconditionError(path.string() +
                                         " was written by a newer version; use that version");
  }
  v1::Bundle out;
  const auto size = static_cast<int>(bytes.size() - kBundleHeaderBytes);
  if (!out.ParseFromArray(bytes.data() + kBundleHeaderBytes, size)) return NoBundle(path);
  if (!out.has_request() || out.result_case() == v1::Bundle::RESULT_NOT_SET) return NoBundle(path);
  return out;
}

absl::StatusOr<std::vector<std::filesystem::path>> ListBundles(
    const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> out;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) {
      if (!std::filesystem::exists(path, error)) {
        return absl::NotFoundError("there is no " + path + "; give bundles or a folder of them");
      }
      out.emplace_back(path);
      continue;
    }
    std::vector<std::filesystem::path> inside;
    for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end;
         entry.increment(error)) {
      if (entry->path().extension() == kBundleSuffix) inside.push_back(entry->path());
    }
    if (inside.empty()) return absl::NotFoundError("there are no bundles in " + path);
    std::ranges::sort(inside);  // their names begin with their numbers
    out.insert(out.end(), inside.begin(), inside.end());
  }
  return out;
}

}  // namespace graspdb::client
