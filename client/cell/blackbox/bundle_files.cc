#include "client/cell/blackbox/bundle_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string_view>
#include <system_error>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "program/text/read_file.h"

namespace graspdb::client {
namespace {

constexpr char kBundleSuffix[] = ".bundle";
constexpr std::string_view kBundleMagic = "GBB";
constexpr char kVersion = 1;
constexpr std::size_t kBundleHeaderBytes = 4;
constexpr std::size_t kMaxBundleBytes = std::numeric_limits<int>::max();  // of a message

absl::Status NoBundle(const std::filesystem::path& path) {
  return absl::DataLossError(path.string() + " is not a bundle, or truncated; leave it out");
}

constexpr std::size_t kDigits = 10;

absl::Status Failed(const std::filesystem::path& path, const std::error_code& error) {
  const std::string text = absl::StrCat("cannot use ", path.string(), ": ", error.message(),
                                        "; choose another folder or make this one writable");
  if (error == std::errc::permission_denied || error == std::errc::read_only_file_system) {
    return absl::PermissionDeniedError(text);
  }
  return absl::FailedPreconditionError(text);
}

// The number at the start of a name; 0 if it is not a file of the ring.
std::uint64_t NumberOf(const std::string& name) {
  std::uint64_t number = 0;
  if (name.size() <= kDigits || name[kDigits] != '-') return 0;
  return absl::SimpleAtoi(name.substr(0, kDigits), &number) ? number : 0;
}

// Temporary file of an interrupted WriteFileAtomically.
bool IsLeftOver(const std::string& name) {
  return NumberOf(name) > 0 && absl::StrContains(name, kBundleSuffix) && name.ends_with(".tmp");
}

}  // namespace

absl::StatusOr<std::string> BundleBytes(const v1::Bundle& bundle) {
  std::string out(kBundleMagic);
  out += kVersion;
  if (bundle.AppendToString(&out)) return out;
  return absl::ResourceExhaustedError("the bundle exceeds the maximum message size");
}

absl::StatusOr<v1::Bundle> ReadBundle(const std::filesystem::path& path) {
  const absl::StatusOr<std::string> read = ReadFile(path, kMaxBundleBytes);
  if (absl::IsInvalidArgument(read.status())) return NoBundle(path);
  if (!read.ok()) return read.status();
  const std::string& bytes = *read;
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

absl::StatusOr<FolderLock> FolderLock::Take(const std::filesystem::path& folder) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot use ", folder.string(), ": ", std::generic_category().message(errno),
                     "; choose another folder or make this one readable"));
  }
  FolderLock out(opened);
  // Any other error means that the file system has no locks.
  if (flock(opened, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return absl::FailedPreconditionError(absl::StrCat(
        folder.string(), " is in use by another process; give each one a folder of its own"));
  }
  return out;
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) close(folder_);
}

absl::StatusOr<BundleRing> BundleRing::Open(BundleRingOptions options) {
  BundleRing out(std::move(options));
  RETURN_IF_ERROR(out.TakeOver());
  RETURN_IF_ERROR(out.MakeSpace(0));
  return out;
}

absl::Status BundleRing::TakeOver() {
  std::error_code error;
  std::filesystem::create_directories(options_.folder, error);
  if (error) return Failed(options_.folder, error);
  ASSIGN_OR_RETURN(lock_, FolderLock::Take(options_.folder));
  std::filesystem::directory_iterator entry(options_.folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::filesystem::path& path = entry->path();
    const std::string name = path.filename().string();
    if (IsLeftOver(name)) {
      std::filesystem::remove(path, error);
      continue;
    }
    if (NumberOf(name) == 0 || path.extension() != kBundleSuffix) continue;
    std::error_code gone;
    const std::uint64_t bytes = std::filesystem::file_size(path, gone);
    if (gone) continue;
    files_.push_back({path, bytes});
    bytes_ += bytes;
    next_ = std::max(next_, NumberOf(name) + 1);
  }
  if (error) return Failed(options_.folder, error);
  std::ranges::sort(files_, {}, &File::path);
  return absl::OkStatus();
}

absl::Status BundleRing::RemoveOldest() {
  std::error_code error;
  // No error if another process already removed it.
  std::filesystem::remove(files_.front().path, error);
  if (error) return Failed(files_.front().path, error);
  bytes_ -= files_.front().bytes;
  files_.pop_front();
  return absl::OkStatus();
}

bool BundleRing::IsDiskFull(std::uint64_t bytes) const {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(options_.folder, error);
  // On errors assume that there is space; if not, the write fails.
  return !error && space.available < options_.min_free_bytes + bytes;
}

absl::Status BundleRing::MakeSpace(std::uint64_t bytes) {
  while (!files_.empty() && (bytes_ + bytes > options_.byte_limit || IsDiskFull(bytes))) {
    RETURN_IF_ERROR(RemoveOldest());
  }
  return absl::OkStatus();
}

absl::Status BundleRing::Add(const std::string& bytes, absl::Time time) {
  if (bytes.size() > options_.byte_limit) {
    return absl::ResourceExhaustedError(absl::StrCat("a bundle of ", bytes.size(),
                                                     " bytes exceeds the limit of the ring (",
                                                     options_.byte_limit, "); increase the limit"));
  }
  RETURN_IF_ERROR(MakeSpace(bytes.size()));
  if (IsDiskFull(bytes.size())) {
    return absl::ResourceExhaustedError(
        absl::StrCat("less than ", options_.min_free_bytes, " bytes would be left free in ",
                     options_.folder.string(), "; free some disk space"));
  }
  const std::string when = absl::FormatTime("%Y%m%dT%H%M%SZ", time, absl::UTCTimeZone());
  const std::filesystem::path path =
      options_.folder / absl::StrFormat("%010d-%s%s", next_, when, kBundleSuffix);
  RETURN_IF_ERROR(files::WriteFileAtomically(path, bytes, files::Durability::kProcessCrash));
  ++next_;
  files_.push_back({path, bytes.size()});
  bytes_ += bytes.size();
  return absl::OkStatus();
}

}  // namespace graspdb::client
