#include "tests/faults/traffic.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace graspdb::faults {
namespace {

constexpr int kUploaders = 2;
constexpr int kStreams = 2;
constexpr int kViewsOfAStream = 5;
// Deletions begin at this number of known views, so that a round takes as long as the one before.
constexpr std::size_t kKeptViews = 300;

std::string NameOf(const v1::UploadViewsRequest& view) {
  return absl::StrCat(view.parent(), "/views/", view.view_id());
}

}  // namespace

Traffic::Traffic(const std::string& server, const SampleViews& samples, int round, Ledger& ledger)
    : server_(server), samples_(samples), round_(round), ledger_(ledger) {
  for (int i = 0; i < kUploaders; ++i) threads_.emplace_back([this, i] { Upload(i); });
  threads_.emplace_back([this] { Delete(); });
  threads_.emplace_back([this] { UploadInBulk(); });
  threads_.emplace_back([this] { BackUp(); });
}

Traffic::~Traffic() {
  for (std::thread& thread : threads_) thread.join();
}

client::Client Traffic::Connect() const {
  return client::Client({.server = server_, .retry = false, .own_connection = true});
}

bool Traffic::GoesOn(const absl::Status& status, const char* call) const {
  if (!status.ok() && !ending_) ADD_FAILURE() << call << ": " << status;
  return status.ok();
}

void Traffic::Upload(int thread) {
  client::Client client = Connect();
  for (int i = 0;; ++i) {
    const int content = (round_ + 7 * i + thread) % samples_.count();
    const v1::UploadViewsRequest view =
        samples_.Request(content, absl::StrCat("r", round_, "-t", thread, "-", i));
    ledger_.Set(NameOf(view), content, Ledger::State::kPending);
    if (!GoesOn(TeachOne(client, view), "UploadViews")) return;
    ledger_.Set(NameOf(view), content, Ledger::State::kTaught);
  }
}

void Traffic::Delete() {
  client::Client client = Connect();
  for (std::uint64_t i = 0;; ++i) {
    const auto [name, content] = ledger_.TakeForDeletion(
        (static_cast<std::uint64_t>(round_) << 20U) + i * 0x9E3779B97F4A7C15U, kKeptViews);
    if (name.empty()) {
      if (ending_) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    if (!GoesOn(client.DeleteView(name), "DeleteView")) return;
    ledger_.Set(name, content, Ledger::State::kDeleted);
  }
}

absl::Status Traffic::StageViews(const std::string& upload, int stream) {
  client::Client client = Connect();
  int next = 0;
  return client.WriteUploadViews(
      [&](v1::WriteUploadViewsRequest* request) {
        if (next == kViewsOfAStream) return false;
        const int content = (round_ + 5 * next + stream) % samples_.count();
        request->set_upload(upload);
        *request->mutable_view() =
            samples_.Request(content, absl::StrCat(upload.substr(8), "-s", stream, "-", next++));
        ledger_.ChangeUpload(
            upload, [&](KnownUpload& known) { known.sent[NameOf(request->view())] = content; });
        return true;
      },
      [&](const v1::WriteUploadViewsResponse& response) {
        EXPECT_FALSE(response.has_error()) << response.ShortDebugString();
        ledger_.ChangeUpload(
            upload,
            [&](KnownUpload& known) { known.staged.insert(known.sent.extract(response.view())); },
            1);
      });
}

absl::Status Traffic::CommitBulk(const std::string& upload) {
  client::Client client = Connect();
  ledger_.ChangeUpload(upload, [](KnownUpload& known) { known.commit_sent = true; });
  v1::CommitUploadRequest request;
  request.set_name(upload);
  committing_ = true;
  absl::Status committed = client.CommitUpload(request).status();
  if (!committed.ok()) return committed;
  committing_ = false;
  ledger_.ChangeUpload(
      upload, [](KnownUpload& known) { known.committed = true; }, 1);
  return committed;
}

void Traffic::UploadInBulk() {
  client::Client client = Connect();
  for (int i = 0;; ++i) {
    const std::string id = absl::StrCat("r", round_, "-", i);
    const std::string upload = absl::StrCat("uploads/", id);
    ledger_.ChangeUpload(upload, [](KnownUpload&) {});
    v1::CreateUploadRequest create;
    create.set_upload_id(id);
    if (!GoesOn(client.CreateUpload(create).status(), "CreateUpload")) return;
    ledger_.ChangeUpload(
        upload, [](KnownUpload& known) { known.created = true; }, 1);
    std::vector<absl::Status> ends(kStreams);
    std::vector<std::thread> streams;
    streams.reserve(kStreams);
    for (int s = 0; s < kStreams; ++s) {
      streams.emplace_back([&, s] { ends[static_cast<std::size_t>(s)] = StageViews(upload, s); });
    }
    for (std::thread& stream : streams) stream.join();
    for (const absl::Status& end : ends) {
      if (!GoesOn(end, "WriteUploadViews")) return;
    }
    if (!GoesOn(CommitBulk(upload), "CommitUpload")) return;
  }
}

void Traffic::BackUp() {
  client::Client client = Connect();
  for (;;) {
    backing_up_ = true;
    const auto made = client.CreateBackup([](std::int64_t) { return absl::OkStatus(); });
    if (!GoesOn(made.status(), "CreateBackup")) return;
    backing_up_ = false;
    ledger_.AddBackup(made->name());
  }
}

}  // namespace graspdb::faults
