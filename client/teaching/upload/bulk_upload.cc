#include "client/teaching/upload/bulk_upload.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "client/sdk/connection.h"
#include "program/base/monotonic_cond_var.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {
namespace {

// Between checks for an interrupt while it waits for a busy server.
constexpr absl::Duration kInterruptPeriod = absl::Milliseconds(50);

// With advice where the server was lost after views were sent. A commit may have been made then,
// which leaves no upload to resume.
absl::Status AfterViews(const absl::Status& status, const char* flag) {
  if (!absl::IsUnavailable(status)) return status;
  absl::Status out = absl::UnavailableError(absl::StrCat(
      status.message(), "; the views sent are safe, run the same command", flag, " to go on"));
  status.ForEachPayload(
      [&](absl::string_view url, const absl::Cord& payload) { out.SetPayload(url, payload); });
  return out;
}

// Whether gRPC ended the stream, and not the server, which gives its errors an id: libgrpc 1.51
// resets one with PROTOCOL_ERROR now and then on a machine without processor time to spare.
bool IsReset(const absl::Status& status) {
  return absl::IsInternal(status) && RequestIdOf(status).empty();
}

class BulkUpload {
 public:
  BulkUpload(Client& client, const ViewsToTeach& views, const BulkUploadOptions& options,
             const UploadWatch& watch)
      : client_(client),
        views_(views),
        options_(options),
        watch_(watch),
        name_(absl::StrCat("uploads/", options.upload_id)),
        known_(client) {}

  // Finds the views of an interrupted upload.
  absl::Status FindStaged() {
    const auto upload = client_.GetUpload(name_);
    if (absl::IsNotFound(upload.status())) return absl::OkStatus();
    if (!upload.ok()) return upload.status();
    if (upload->state() == v1::UPLOAD_STATE_COMMITTED) return client_.DeleteUpload(name_);
    is_created_ = true;
    ASSIGN_OR_RETURN(const auto staged, client_.ListUploadViews(name_));
    for (const v1::UploadView& view : staged) {
      if (!view.has_error()) staged_.insert(view.name());
    }
    return absl::OkStatus();
  }

  absl::StatusOr<BulkUploadResult> Run() {
    std::vector<std::thread> threads;
    const int count = std::clamp(static_cast<int>(views_.count), 1, options_.streams);
    threads.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      threads.emplace_back([this] { Stop(Stream()); });
    }
    for (std::thread& thread : threads) thread.join();
    absl::MutexLock lock(&mutex_);
    if (!stopped_.ok()) return is_created_ ? AfterViews(stopped_, " with --resume") : stopped_;
    std::ranges::sort(result_.failed, {}, &FailedView::index);
    if (options_.atomic && !result_.failed.empty()) return NotAll();
    if (is_created_) {
      v1::CommitUploadRequest request;
      request.set_name(name_);
      request.set_skip_failed(!options_.atomic);
      const auto committed = client_.CommitUpload(request);
      if (!committed.ok()) return AfterViews(committed.status(), "");
      result_.counts.created +=
          static_cast<int>(committed->created_count() + committed->replaced_count());
      result_.counts.existing += static_cast<int>(committed->existing_count());
    }
    return std::move(result_);
  }

  // Reads all views, and counts what Run() would send.
  absl::StatusOr<UploadPlan> Plan() {
    UploadPlan plan;
    std::set<std::string> new_views;
    v1::UploadViewsRequest request;
    for (std::size_t i = 0; i < views_.count; ++i) {
      if (watch_.cancelled && watch_.cancelled()) return absl::CancelledError("interrupted");
      const absl::StatusOr<Place> place = Prepare(i, &request);
      if (!place.ok()) {
        plan.unreadable.push_back({i, place.status()});
        continue;
      }
      if (*place == Place::kUnknown) return Stopped();
      if (*place == Place::kNowhere) {
        ++(new_views.insert(ViewNameOf(request)).second ? plan.new_count : plan.repeated_count);
      }
      plan.existing_count += *place == Place::kCatalogue ? 1 : 0;
      plan.staged_count += *place == Place::kUpload ? 1 : 0;
      if (watch_.report) watch_.report(i + 1);
    }
    return plan;
  }

 private:
  enum class Place { kNowhere, kCatalogue, kUpload, kUnknown };

  // Fills the request for view `i`, and finds out where it is already; kUnknown stops the upload.
  // Errors of the view.
  absl::StatusOr<Place> Prepare(std::size_t i, v1::UploadViewsRequest* request) {
    request->Clear();
    RETURN_IF_ERROR(MakeRequest(views_, i, request));
    if (staged_.contains(ViewNameOf(*request))) return Place::kUpload;
    if (views_.replace) return Place::kNowhere;
    const absl::StatusOr<bool> known = known_.Has(request->parent(), request->view_id());
    if (known.ok()) return *known ? Place::kCatalogue : Place::kNowhere;
    Stop(known.status());
    return Place::kUnknown;
  }

  // Sends views until none are left. Those that a busy server has not answered are sent again,
  // until it has answered none of all streams for BusyRetries. Those of a reset stream are, too, if
  // views were answered meanwhile.
  absl::Status Stream() {
    std::deque<std::size_t> unanswered;
    std::optional<BusyRetries> retries;
    std::size_t done = 0;
    for (;;) {
      absl::Status status = SendOnce(&unanswered);
      const std::size_t now = DoneCount();
      if (IsReset(status) && now > done) {
        done = now;
        continue;
      }
      if (!retries || now > done) {
        retries.emplace(client_.busy_retries());
        done = now;
      }
      const std::optional<absl::Duration> pause =
          retries->Next(status, MonotonicTime::InfiniteFuture());
      if (!pause) return status;
      RETURN_IF_ERROR(Wait(*pause));
    }
  }

  // Sends the unanswered views and then others over one stream; those without a response are
  // unanswered afterwards.
  absl::Status SendOnce(std::deque<std::size_t>* unanswered) {
    std::size_t sent = 0;  // the first of `unanswered`
    return client_.WriteUploadViews(
        [&](v1::WriteUploadViewsRequest* request) -> absl::StatusOr<bool> {
          for (;;) {
            if (sent == unanswered->size()) {
              ASSIGN_OR_RETURN(const std::size_t next, Next());
              if (next == views_.count) return false;
              unanswered->push_back(next);
            }
            const std::size_t i = (*unanswered)[sent];
            const absl::StatusOr<Place> place = Prepare(i, request->mutable_view());
            if (place.ok() && *place == Place::kUnknown) return Stopped();
            if (place.ok() && *place == Place::kNowhere) {
              RETURN_IF_ERROR(CreateOnce());
              request->set_upload(name_);
              ++sent;
              return true;
            }
            unanswered->erase(unanswered->begin() + static_cast<std::ptrdiff_t>(sent));
            Done(i, place.status(), place.ok() && *place == Place::kCatalogue);
          }
        },
        [&](const v1::WriteUploadViewsResponse& response) {
          const std::size_t i = unanswered->front();
          unanswered->pop_front();
          --sent;
          Done(i,
               absl::Status(static_cast<absl::StatusCode>(response.error().code()),
                            response.error().message()),
               /*existing=*/false);
        });
  }

  // The next view, or views_.count without one.
  absl::StatusOr<std::size_t> Next() {
    absl::MutexLock lock(&mutex_);
    RETURN_IF_ERROR(GoOn());
    return next_ == views_.count ? next_ : next_++;
  }

  // The error of another stream, or CANCELLED.
  absl::Status GoOn() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (!stopped_.ok() || !watch_.cancelled || !watch_.cancelled()) return stopped_;
    return absl::CancelledError(
        absl::StrCat("interrupted after ", done_, " of ", views_.count,
                     " views, which are safe; run the same command again to go on, or `graspdb "
                     "uploads delete ",
                     options_.upload_id, "` to drop them"));
  }

  // Errors of GoOn, also while it waits.
  absl::Status Wait(absl::Duration pause) {
    const MonotonicTime end = MonotonicTime::Now() + pause;
    absl::MutexLock lock(&mutex_);
    for (;;) {
      RETURN_IF_ERROR(GoOn());
      const MonotonicTime now = MonotonicTime::Now();
      if (now >= end) return absl::OkStatus();
      has_stopped_.WaitUntil(&mutex_, std::min(end, now + kInterruptPeriod));
    }
  }

  std::size_t DoneCount() {
    absl::MutexLock lock(&mutex_);
    return done_;
  }

  absl::Status CreateOnce() {
    absl::MutexLock lock(&mutex_);
    if (is_created_) return absl::OkStatus();
    v1::CreateUploadRequest request;
    request.set_upload_id(options_.upload_id);
    request.mutable_upload()->set_replace(views_.replace);
    request.mutable_upload()->set_expected_view_count(static_cast<std::int64_t>(views_.count));
    const auto created = client_.CreateUpload(request);
    is_created_ = created.ok();
    if (!absl::IsAlreadyExists(created.status())) return created.status();
    return absl::AlreadyExistsError(absl::StrCat(  // there was none a moment ago: FindStaged
        "another import of the same views has just begun; wait for its end, and then run the same "
        "command again if views are missing (`graspdb uploads show ",
        options_.upload_id, "` prints its progress)"));
  }

  void Done(std::size_t i, const absl::Status& error, bool existing) {
    absl::MutexLock lock(&mutex_);
    if (!error.ok()) result_.failed.push_back({i, error});
    if (existing) ++result_.counts.existing;
    ++done_;
    if (watch_.report) watch_.report(done_);
  }

  void Stop(const absl::Status& status) {
    absl::MutexLock lock(&mutex_);
    stopped_.Update(status);
    if (!stopped_.ok()) has_stopped_.SignalAll();
  }

  absl::Status Stopped() {
    absl::MutexLock lock(&mutex_);
    return stopped_;
  }

  absl::Status NotAll() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    const FailedView& first = result_.failed.front();
    return absl::FailedPreconditionError(absl::StrCat(
        result_.failed.size(), " of ", views_.count, " views cannot be taught, so none is (",
        views_.name_of ? views_.name_of(first.index) : absl::StrCat("view ", first.index + 1), ": ",
        first.error.message(),
        "); fix them and run the same command again, or publish the others by `graspdb uploads "
        "commit ",
        options_.upload_id, " --skip-failed`"));
  }

  Client& client_;
  const ViewsToTeach& views_;
  const BulkUploadOptions& options_;
  const UploadWatch& watch_;
  const std::string name_;
  KnownViews known_;
  std::set<std::string> staged_;  // sent by an upload that was interrupted

  absl::Mutex mutex_;
  MonotonicCondVar has_stopped_;
  std::size_t next_ ABSL_GUARDED_BY(mutex_) = 0;
  std::size_t done_ ABSL_GUARDED_BY(mutex_) = 0;
  bool is_created_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Status stopped_ ABSL_GUARDED_BY(mutex_);
  BulkUploadResult result_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

absl::StatusOr<BulkUploadResult> TeachInBulk(Client& client, const ViewsToTeach& views,
                                             const BulkUploadOptions& options,
                                             const UploadWatch& watch) {
  BulkUpload upload(client, views, options, watch);
  RETURN_IF_ERROR(upload.FindStaged());
  return upload.Run();
}

absl::StatusOr<UploadPlan> PlanUpload(Client& client, const ViewsToTeach& views,
                                      const std::string& upload_id, const UploadWatch& watch) {
  const BulkUploadOptions options = {.upload_id = upload_id};
  BulkUpload upload(client, views, options, watch);
  RETURN_IF_ERROR(upload.FindStaged());
  return upload.Plan();
}

}  // namespace graspdb::client
