#include "client/cell/agent/jobs/cell_cache.h"

#include <spdlog/spdlog.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

// Reads of the cell between two of the server's version: a server may be replaced between them.
constexpr int kTurnsOfVersion = 12;

absl::StatusOr<KeptCell> Kept(const std::string& name, const absl::StatusOr<v1::Cell>& cell) {
  if (absl::IsNotFound(cell.status())) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the server has no ", name, "; create it with: graspdb cells set ", name.substr(6)));
  }
  if (!cell.ok()) return cell.status();
  ASSIGN_OR_RETURN(CellFrames frames, FramesOf(*cell));
  KeptCell out{frames, std::nullopt};
  if (cell->has_workspace()) {
    const v1::Vector3& low = cell->workspace().min();
    const v1::Vector3& high = cell->workspace().max();
    out.workspace = {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
  }
  return out;
}

}  // namespace

CellCache::CellCache(Client& client, std::string cell, absl::Duration period)
    : client_(client),
      name_(std::move(cell)),
      period_(period),
      cell_(absl::UnavailableError("the cell has not been read yet")),
      state_(cell_.status()),
      thread_([this] { Watch(); }) {}

CellCache::~CellCache() {
  stop_.Raise();
  thread_.join();
}

absl::StatusOr<KeptCell> CellCache::Get(MonotonicTime deadline) {
  {
    absl::MutexLock lock(&mutex_);
    if (cell_.ok()) return cell_;
  }
  RETURN_IF_ERROR(Refresh(deadline - MonotonicTime::Now()));
  absl::MutexLock lock(&mutex_);
  return cell_;
}

absl::Status CellCache::Refresh(std::optional<absl::Duration> timeout) {
  const std::uint64_t number = ++requests_;
  const absl::StatusOr<v1::Cell> answer = client_.GetCell(name_, timeout);
  absl::StatusOr<KeptCell> cell = Kept(name_, answer);
  // The server may be slower than its caller, or gone: state_ stays.
  if (timeout && absl::IsDeadlineExceeded(cell.status())) return cell.status();
  absl::MutexLock lock(&mutex_);
  // Two threads refresh: an answer that is older than the one that is kept does not replace it.
  if (number < kept_request_) return cell.status();
  kept_request_ = number;
  if (!is_state_known_ || state_.code() != cell.status().code()) {
    if (cell.ok()) {
      spdlog::info("event=server_there cell={}", name_);
    } else {
      // A server that has no such cell, one with wrong poses, or refuses to return it, is there.
      const bool is_there =
          !absl::IsUnavailable(answer.status()) && !absl::IsDeadlineExceeded(answer.status());
      spdlog::warn("event={} error={}", is_there ? "cell_unusable" : "server_lost",
                   LogField(std::string(cell.status().message())));
    }
  }
  state_ = cell.status();
  is_state_known_ = true;
  // The cached cell stays valid while the server is unavailable or busy.
  if (cell.ok() || absl::IsFailedPrecondition(state_)) cell_ = std::move(cell);
  return state_;
}

absl::Status CellCache::state() const {
  absl::MutexLock lock(&mutex_);
  return state_;
}

std::string CellCache::server_version() const {
  absl::MutexLock lock(&mutex_);
  return server_version_;
}

void CellCache::ReadServerVersion() {
  const auto status = client_.GetCatalogStatus();
  if (!status.ok()) return;
  absl::MutexLock lock(&mutex_);
  server_version_ = status->server_version();
}

void CellCache::Watch() {
  bool was_there = false;
  int turn = 0;
  do {
    const bool is_there = Refresh().ok();  // otherwise stored in state_ and logged
    if (is_there && (!was_there || turn % kTurnsOfVersion == 0)) ReadServerVersion();
    was_there = is_there;
    ++turn;
  } while (!stop_.Wait(absl::ToChronoNanoseconds(period_)));
}

absl::StatusOr<std::shared_ptr<const LabelledObjects>> Labels::At(const std::string& catalog_id,
                                                                  std::int64_t revision) {
  {
    absl::MutexLock lock(&mutex_);
    if (catalog_id_ == catalog_id && revision_ == revision) return objects_;
  }
  ASSIGN_OR_RETURN(const std::vector<v1::Object> listed, client_.ListObjects());
  auto objects = std::make_shared<LabelledObjects>();
  for (const v1::Object& object : listed) {
    for (const std::string& label : object.labels()) objects->emplace(object.name(), label);
  }
  absl::MutexLock lock(&mutex_);
  catalog_id_ = catalog_id;
  revision_ = revision;
  objects_ = std::move(objects);
  return objects_;
}

}  // namespace graspdb::client
