#include "tests/faults/ledger_check.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace graspdb::faults {
namespace {

using State = KnownView::State;

constexpr std::size_t kKeptBackups = 2;
// Of the scans whose candidates are compared with the catalogue.
constexpr int kScans = 2;
// Descriptors of the same points differ by rounding at most.
constexpr double kSameDescriptor = 1e-6;

}  // namespace

void LedgerCheck::Run(std::mt19937_64& random, bool everything) {
  CheckUploads(random);
  CheckViews(everything);
  CheckNames();
  CheckIndex(random);
  CheckBackups();
  ledger_.touched().clear();
  ledger_.uploads().clear();
}

void LedgerCheck::Lost(const std::string& what) {
  ++counts_.lost;
  ADD_FAILURE() << "lost: " << what;
}

void LedgerCheck::CheckView(const std::string& name, KnownView& known) {
  const absl::StatusOr<v1::View> view = client_.GetView(name);
  if (!view.ok() && !absl::IsNotFound(view.status())) {
    return Lost(absl::StrCat(name, ": ", std::string(view.status().message())));
  }
  if (view.ok() && !samples_.IsStored(*view, known.content)) Lost(name + " has other bytes");
  if (known.state == State::kTaught && !view.ok()) Lost(name);
  if (known.state == State::kDeleted && view.ok()) Lost("the deletion of " + name);
  if (known.state != State::kPending) return;
  ++counts_.unanswered;
  counts_.applied += view.ok() ? 1 : 0;
  known.state = view.ok() ? State::kTaught : State::kDeleted;
}

void LedgerCheck::CheckViews(bool everything) {
  for (auto& [name, known] : ledger_.views()) {
    if (everything || ledger_.touched().contains(name)) CheckView(name, known);
  }
  std::erase_if(ledger_.views(),
                [](const auto& view) { return view.second.state == State::kDeleted; });
}

// The views of a committed upload become known as taught, and are checked with the others.
void LedgerCheck::AddPublished(const KnownUpload& known) {
  for (const auto& [name, content] : known.staged) ledger_.Set(name, content, State::kTaught);
  for (const auto& [name, content] : known.sent) ledger_.Set(name, content, State::kPending);
}

void LedgerCheck::CheckUploads(std::mt19937_64& random) {
  for (const auto& [name, known] : ledger_.uploads()) {
    const absl::StatusOr<v1::Upload> upload = client_.GetUpload(name);
    if (!upload.ok()) {
      if (known.created) Lost(name);
      continue;
    }
    const bool committed = upload->state() == v1::UPLOAD_STATE_COMMITTED;
    if (known.committed && !committed) Lost("the commit of " + name);
    if (committed) {
      EXPECT_TRUE(known.commit_sent) << name;
      EXPECT_EQ(upload->created_count(), std::ssize(known.staged)) << name << ": all or none";
      AddPublished(known);
    } else {
      ++counts_.uploads;
      CheckOpenUpload(name, known, random() % 4 != 0);
    }
  }
}

// None of its views may be in the catalogue yet, which CheckNames() notices for those that are
// deleted here; all acknowledged ones must be staged.
void LedgerCheck::CheckOpenUpload(const std::string& name, const KnownUpload& known,
                                  bool completes) {
  const absl::StatusOr<std::vector<v1::UploadView>> staged = client_.ListUploadViews(name);
  ASSERT_TRUE(staged.ok()) << staged.status();
  for (const auto& [view, content] : known.staged) {
    if (std::ranges::find(*staged, view, &v1::UploadView::name) == staged->end()) {
      Lost(absl::StrCat(view, " of ", name));
    }
    EXPECT_TRUE(absl::IsNotFound(client_.GetView(view).status())) << view << " before the commit";
  }
  if (!completes) {
    EXPECT_TRUE(client_.DeleteUpload(name).ok());
    return;
  }
  v1::CommitUploadRequest commit;
  commit.set_name(name);
  const absl::StatusOr<v1::Upload> committed = client_.CommitUpload(commit);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->created_count(), std::ssize(*staged));
  AddPublished(known);
}

void LedgerCheck::CheckNames() {
  std::int64_t listed = 0;
  for (int content = 0; content < samples_.count(); ++content) {
    const auto views = client_.ListViews(samples_.StablePoseOf(content));
    ASSERT_TRUE(views.ok()) << views.status();
    listed += std::ssize(*views);
    for (const v1::View& view : *views) {
      EXPECT_TRUE(ledger_.views().contains(view.name())) << view.name() << " was never taught";
    }
  }
  EXPECT_EQ(listed, std::ssize(ledger_.views()));
  const absl::StatusOr<v1::CatalogStatus> status = client_.GetCatalogStatus();
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_EQ(status->view_count(), listed);
  EXPECT_EQ(status->left_out_record_count(), 0);
}

// The nearest views of a scan are views of the catalogue, and one of the scan's own content is the
// nearest.
void LedgerCheck::CheckIndex(std::mt19937_64& random) {
  const auto& views = ledger_.views();
  for (int i = 0; i < kScans && !views.empty(); ++i) {
    const auto taught =
        std::next(views.begin(), static_cast<std::ptrdiff_t>(random() % views.size()));
    const auto answer = client_.Recognize(samples_.Scan(taught->second.content));
    ASSERT_TRUE(answer.ok()) << answer.status();
    ASSERT_EQ(answer->detections_size(), 1);
    const auto& candidates = answer->detections(0).candidates();
    ASSERT_FALSE(candidates.empty());
    EXPECT_LT(candidates[0].descriptor_distance(), kSameDescriptor) << taught->first;
    for (const v1::Candidate& candidate : candidates) {
      const auto known = views.find(candidate.view());
      ASSERT_NE(known, views.end()) << candidate.view() << " is in the index only";
      if (candidate.descriptor_distance() < kSameDescriptor) {
        EXPECT_EQ(known->second.content, taught->second.content);
      }
    }
  }
}

void LedgerCheck::CheckBackups() {
  const absl::StatusOr<std::vector<v1::Backup>> listed = client_.ListBackups();
  ASSERT_TRUE(listed.ok()) << listed.status();
  for (const std::string& name : ledger_.backups()) {
    if (std::ranges::find(*listed, name, &v1::Backup::name) == listed->end()) Lost(name);
  }
  const auto ignore = [](std::int64_t) { return absl::OkStatus(); };
  for (std::size_t i = 0; i < listed->size(); ++i) {
    const v1::Backup& backup = (*listed)[i];
    EXPECT_EQ(backup.damage(), "");
    if (i + 1 == listed->size()) {
      const auto verified = client_.VerifyBackup(backup.name(), ignore);
      EXPECT_TRUE(verified.ok()) << verified.status();
    } else if (i + kKeptBackups < listed->size()) {
      EXPECT_TRUE(client_.DeleteBackup(backup.name()).ok());
      std::erase(ledger_.backups(), backup.name());
    }
  }
}

}  // namespace graspdb::faults
