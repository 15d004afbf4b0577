#include "server/access/identities_file.h"

#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "program/text/text_encoding.h"

namespace graspdb::server {
namespace {

// At most one byte more than allowed, which the parser rejects.
absl::StatusOr<std::string> ReadBounded(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string out(kMaxIdentitiesBytes + 1, '\0');
  file.read(out.data(), static_cast<std::streamsize>(out.size()));
  if (!file.is_open() || file.bad()) {
    return absl::FailedPreconditionError(absl::StrCat("cannot read --identities ", path, " (",
                                                      std::strerror(errno),
                                                      "); check the path and its permissions"));
  }
  out.resize(static_cast<std::size_t>(file.gcount()));
  return out;
}

}  // namespace

IdentitiesFile::IdentitiesFile(const std::string& path) : path_(path), file_({path}) {}

absl::StatusOr<std::unique_ptr<IdentitiesFile>> IdentitiesFile::Open(const std::string& path) {
  std::unique_ptr<IdentitiesFile> out(new IdentitiesFile(path));
  RETURN_IF_ERROR(out->Load());
  out->file_.Start([file = out.get(), last_error = std::string()]() mutable {
    const absl::Status status = file->Load();
    file->state_.Note(status);
    const std::string error(status.message());
    if (status.ok()) {
      spdlog::info("event=identities_read file={} count={}", LogField(file->path_),
                   file->Get()->size());
    } else if (error != last_error) {
      spdlog::error("event=identities_invalid error={}", LogField(error));
    }
    last_error = error;
    // A revocation must not be missed because no file could be opened at that moment.
    return status.ok();
  });
  return out;
}

std::shared_ptr<const Identities> IdentitiesFile::Get() const {
  absl::MutexLock lock(&mutex_);
  return identities_;
}

absl::Status IdentitiesFile::Load() {
  ASSIGN_OR_RETURN(std::string text, ReadBounded(path_));
  if (absl::Status taken = TakeUtf8(absl::StrCat("--identities ", path_), &text); !taken.ok()) {
    return absl::FailedPreconditionError(taken.message());
  }
  absl::StatusOr<Identities> parsed = Identities::Parse(text);
  if (!parsed.ok()) {
    return absl::FailedPreconditionError(
        absl::StrCat("--identities ", path_, ": ", parsed.status().message()));
  }
  // As of a file that was emptied, or is being written in place: every caller would be refused.
  if (parsed->size() == 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("--identities ", path_,
                     " has no identity; graspdb-server token NAME prints a line for one"));
  }
  auto identities = std::make_shared<const Identities>(*std::move(parsed));
  absl::MutexLock lock(&mutex_);
  identities_ = std::move(identities);
  return absl::OkStatus();
}

}  // namespace graspdb::server
