// Revisions, change records, the listener.
#include <atomic>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;

class ChangesTest : public ::testing::Test {
 protected:
  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db");
};

TEST_F(ChangesTest, EveryMutationGetsTheNextRevision) {
  std::vector<std::int64_t> revisions = {catalogue_->revision()};
  MakeHistory(*catalogue_, [&] { revisions.push_back(catalogue_->revision()); });
  EXPECT_THAT(revisions, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
}

TEST_F(ChangesTest, ReplayedChangeRecordsGiveTheRecordsAfterEveryMutation) {
  // TakePicture() replays them and compares.
  MakeHistory(*catalogue_, [&] { EXPECT_TRUE(TakePicture(*catalogue_).ok()); });
}

TEST_F(ChangesTest, AChangeRecordHoldsTheAfterImageButNoCloud) {
  MakeHistory(*catalogue_, [] {});
  const auto changes = catalogue_->ReadChanges(5, 1);
  ASSERT_TRUE(changes.ok());
  ASSERT_EQ(changes->size(), 1U);
  const ChangeRecord& change = changes->front();
  EXPECT_EQ(change.revision(), 6);
  EXPECT_TRUE(change.has_time());
  ASSERT_EQ(change.mutations_size(), 2);
  EXPECT_EQ(change.mutations(0).kind(), Mutation::KIND_PUT);
  EXPECT_EQ(change.mutations(0).column_family(), "views");
  EXPECT_EQ(change.mutations(0).key(), "objects/mug/stablePoses/upright/views/1");
  ViewRecord record;
  ASSERT_TRUE(record.ParseFromString(change.mutations(0).value()));
  EXPECT_EQ(record.content_digest(), "digest 2");
  EXPECT_EQ(change.mutations(1).column_family(), "clouds");
  EXPECT_EQ(change.mutations(1).key(), change.mutations(0).key());
  EXPECT_TRUE(change.mutations(1).value().empty());
}

TEST_F(ChangesTest, EverythingSurvivesARestart) {
  MakeHistory(*catalogue_, [] {});
  const auto before = TakePicture(*catalogue_);
  ASSERT_TRUE(before.ok());
  for (int restart = 0; restart < 3; ++restart) {
    catalogue_.reset();
    catalogue_ = OpenOrDie(directory_ / "db");
    const auto after = TakePicture(*catalogue_);
    ASSERT_TRUE(after.ok()) << after.status();
    EXPECT_EQ(*after, *before);
  }
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("next")).ok());
  EXPECT_EQ(catalogue_->revision(), 13);
}

TEST_F(ChangesTest, ChangesAreReadInPieces) {
  MakeHistory(*catalogue_, [] {});
  std::vector<std::int64_t> revisions;
  for (std::int64_t after = 0; after < 12;) {
    const auto changes = catalogue_->ReadChanges(after, 5);
    ASSERT_TRUE(changes.ok());
    ASSERT_FALSE(changes->empty());
    ASSERT_LE(changes->size(), 5U);
    for (const ChangeRecord& change : *changes) revisions.push_back(change.revision());
    after = revisions.back();
  }
  EXPECT_THAT(revisions, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  EXPECT_TRUE(catalogue_->ReadChanges(12, 5)->empty());
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->ReadChanges(-1, 5).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->ReadChanges(0, 0).status()));
}

TEST_F(ChangesTest, FewLargeChangesAreReadAtOnce) {
  const std::string long_name(600'000, 'x');
  for (const char* id : {"a", "b", "c", "d"}) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject(id, long_name)).ok());
  }
  const auto first = catalogue_->ReadChanges(0, 100);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->size(), 2U);
  const auto second = catalogue_->ReadChanges(2, 100);
  ASSERT_TRUE(second.ok()) << second.status();
  ASSERT_EQ(second->size(), 2U);
  EXPECT_EQ(second->back().revision(), 4);
}

TEST_F(ChangesTest, ListenerIsNotifiedBeforeTheCallReturns) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("before")).ok());
  std::vector<std::int64_t> notified;
  const auto since = catalogue_->Subscribe(
      [&](const ChangeRecord& change) { notified.push_back(change.revision()); });
  ASSERT_TRUE(since.ok());
  EXPECT_EQ(*since, 1);
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  EXPECT_THAT(notified, ElementsAre(2));
  EXPECT_FALSE(catalogue_->CreateObject(MakeObject("mug")).ok());
  EXPECT_THAT(notified, ElementsAre(2)) << "a rejected change has no revision";
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  const std::string views = "objects/mug/stablePoses/upright/views/";
  const std::vector<NewView> both = {MakeView(views + "0", 1), MakeView(views + "1", 2)};
  ASSERT_TRUE(catalogue_->PutViews(both).ok());
  EXPECT_THAT(notified, ElementsAre(2, 3, 4, 5));
  ASSERT_TRUE(catalogue_->Subscribe({}).ok());
  ASSERT_TRUE(catalogue_->DeleteView(views + "0").ok());
  EXPECT_EQ(notified.size(), 4U) << "the listener was removed";
}

TEST_F(ChangesTest, TheListenerSeesTheChangeOnDisk) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  int calls = 0;
  ASSERT_TRUE(catalogue_
                  ->Subscribe([&](const ChangeRecord& change) {
                    ++calls;
                    EXPECT_EQ(catalogue_->revision(), change.revision());
                    EXPECT_TRUE(catalogue_->GetObject("objects/bowl").ok());
                    // The state that a crash at this moment would leave.
                    CopyDatabase(directory_ / "db", directory_ / "copy");
                    EXPECT_EQ(OpenOrDie(directory_ / "copy")->revision(), change.revision());
                  })
                  .ok());
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("bowl")).ok());
  EXPECT_EQ(calls, 1);
}

TEST_F(ChangesTest, ThrowingListenerMissesThatChangeOnly) {
  std::vector<std::int64_t> notified;
  ASSERT_TRUE(catalogue_
                  ->Subscribe([&](const ChangeRecord& change) {
                    if (change.revision() == 1) throw std::bad_alloc();
                    notified.push_back(change.revision());
                  })
                  .ok());
  EXPECT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  EXPECT_TRUE(catalogue_->GetObject("objects/mug").ok());
  EXPECT_TRUE(catalogue_->CreateObject(MakeObject("bowl")).ok());
  EXPECT_THAT(notified, ElementsAre(2));
}

TEST_F(ChangesTest, ChangesFromWithinTheListenerAreRejected) {
  absl::Status changed;
  absl::Status subscribed;
  ASSERT_TRUE(catalogue_
                  ->Subscribe([&](const ChangeRecord&) {
                    changed = catalogue_->CreateObject(MakeObject("inner")).status();
                    subscribed = catalogue_->Subscribe({}).status();
                  })
                  .ok());
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("outer")).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(changed)) << changed;
  EXPECT_TRUE(absl::IsFailedPrecondition(subscribed)) << subscribed;
  ASSERT_TRUE(catalogue_->Subscribe({}).ok());
  EXPECT_TRUE(catalogue_->CreateObject(MakeObject("inner")).ok()) << "and allowed afterwards";
}

TEST_F(ChangesTest, ConcurrentWritersGetGaplessRevisionsAndTheListenerTheirOrder) {
  constexpr int kThreads = 4;
  constexpr int kWrites = 25;
  std::vector<std::int64_t> notified;  // the listener is called by one thread at a time
  ASSERT_TRUE(
      catalogue_
          ->Subscribe([&](const ChangeRecord& change) { notified.push_back(change.revision()); })
          .ok());
  std::atomic<bool> done = false;
  std::thread reader([&] {
    while (!done) {
      std::int64_t objects = 0;
      RecordVisitor visitor;
      visitor.object = [&objects](const v1::Object&) {
        ++objects;
        return absl::OkStatus();
      };
      const auto revision = catalogue_->ForEach(visitor);
      ASSERT_TRUE(revision.ok());
      // Every change makes one object, so a mixed state would show.
      ASSERT_EQ(*revision, objects);
    }
  });
  std::vector<std::thread> writers;
  writers.reserve(kThreads);
  for (int thread = 0; thread < kThreads; ++thread) {
    writers.emplace_back([this, thread] {
      for (int i = 0; i < kWrites; ++i) {
        const std::string id = std::to_string(thread) + "-" + std::to_string(i);
        EXPECT_TRUE(catalogue_->CreateObject(MakeObject(id)).ok());
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  done = true;
  reader.join();
  ASSERT_EQ(notified.size(), static_cast<std::size_t>(kThreads * kWrites));
  for (std::size_t i = 0; i < notified.size(); ++i) {
    EXPECT_EQ(notified[i], static_cast<std::int64_t>(i) + 1);
  }
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(ChangesTest, ConcurrentUpdatesLoseNothing) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  std::vector<std::thread> writers;
  writers.reserve(4);
  for (int thread = 0; thread < 4; ++thread) {
    writers.emplace_back([this] {
      for (int i = 0; i < 10; ++i) {
        const auto append = [](v1::Object& object) {
          object.set_display_name(object.display_name() + "x");
          return absl::OkStatus();
        };
        EXPECT_TRUE(catalogue_->UpdateObject("objects/mug", "", append).ok());
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(catalogue_->GetObject("objects/mug")->display_name(), std::string(40, 'x'));
}

}  // namespace
}  // namespace graspdb::storage
