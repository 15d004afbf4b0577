#include "client/cell/cell_keeper.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "logging/log_field.h"

namespace graspdb::client {
namespace {

absl::StatusOr<KeptCell> Read(Client& client, const std::string& name) {
  absl::StatusOr<v1::Cell> cell = client.GetCell(name);
  if (absl::IsNotFound(cell.status())) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the server knows no ", name, "; make it with: graspdb cells set ", name.substr(6)));
  }
  if (!cell.ok()) return cell.status();
  absl::StatusOr<CellFrames> frames = FramesOf(*cell);
  if (!frames.ok()) return frames.status();
  KeptCell out{*frames, std::nullopt};
  if (cell->has_workspace()) {
    const v1::Vector3& low = cell->workspace().min();
    const v1::Vector3& high = cell->workspace().max();
    out.workspace = {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
  }
  return out;
}

}  // namespace

CellKeeper::CellKeeper(Client& client, std::string cell, absl::Duration period)
    : client_(client),
      name_(std::move(cell)),
      period_(period),
      cell_(absl::UnavailableError("the cell has not been read yet")),
      state_(cell_.status()),
      thread_([this] { Watch(); }) {}

CellKeeper::~CellKeeper() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
}

absl::StatusOr<KeptCell> CellKeeper::Get() {
  {
    absl::MutexLock lock(&mutex_);
    if (cell_.ok()) return cell_;
  }
  if (absl::Status status = Refresh(); !status.ok()) return status;
  absl::MutexLock lock(&mutex_);
  return cell_;
}

absl::Status CellKeeper::Refresh() {
  absl::StatusOr<KeptCell> cell = Read(client_, name_);
  absl::MutexLock lock(&mutex_);
  if (state_.code() != cell.status().code()) {
    if (cell.ok()) {
      spdlog::info("event=server_there cell={}", name_);
    } else {
      spdlog::warn("event=server_lost error={}", LogField(std::string(cell.status().message())));
    }
  }
  state_ = cell.status();
  // A server that is away, or busy, does not move the cell.
  if (cell.ok() || absl::IsFailedPrecondition(state_)) cell_ = std::move(cell);
  return state_;
}

absl::Status CellKeeper::state() const {
  absl::MutexLock lock(&mutex_);
  return state_;
}

void CellKeeper::Watch() {
  for (;;) {
    (void)Refresh();  // kept in state_, and logged
    absl::MutexLock lock(&mutex_);
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopping_), period_)) return;
  }
}

}  // namespace graspdb::client
