// Filters that are kept for the next frames.
#include "server/live/filtered_snapshots.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/live/taught_poses.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {
namespace {

constexpr int kSomeBins = 4;
constexpr int kSomeObjects = 10;

Visibility LabelledWith(const std::string& label) { return {.labels = {label}}; }

// A view of each of ten objects. Object i has the labels all-0, all-1, ..., and of the labels
// not-0, not-1, ... all but its own.
std::shared_ptr<const LiveSnapshot> LabelledSnapshot() {
  ReleaseGates gates;
  storage::RecordVisitor visitor;
  ReleaseGates::AddTo(&visitor, &gates);
  std::vector<recognition::IndexedView> views;
  views.reserve(kSomeObjects);
  for (int i = 0; i < kSomeObjects; ++i) {
    v1::Object object;
    object.set_name(absl::StrCat("objects/", i));
    for (int label = 0; label < kSomeObjects; ++label) {
      object.add_labels(absl::StrCat("all-", label));
      if (label != i) object.add_labels(absl::StrCat("not-", label));
    }
    EXPECT_TRUE(visitor.object(object).ok());
    auto view = std::make_shared<recognition::TaughtView>();
    view->object = object.name();
    view->stable_pose = view->object + "/stablePoses/p";
    view->name = view->stable_pose + "/views/v";
    views.push_back({view, recognition::Descriptor(kSomeBins, 0.25F)});
  }
  return std::make_shared<const LiveSnapshot>(
      LiveSnapshot{{1, recognition::DescriptorIndex(kSomeBins).With(views),
                    std::make_shared<const TaughtPoses>()},
                   std::make_shared<const ReleaseGates>(std::move(gates))});
}

TEST(FilteredSnapshotsTest, FiltersThatCopyNothingAreAllKept) {
  FilteredSnapshots filters;
  const auto base = LabelledSnapshot();
  const auto first = filters.Get(base, LabelledWith("all-0"));
  EXPECT_EQ(first->index.view_count(), 10U);
  for (int i = 1; i < kSomeObjects; ++i) {
    (void)filters.Get(base, LabelledWith(absl::StrCat("all-", i)));
  }
  EXPECT_EQ(filters.Get(base, LabelledWith("all-0")), first) << "it was made again";
}

TEST(FilteredSnapshotsTest, FiltersThatCopyMoreThanTwiceTheCatalogueAreDropped) {
  FilteredSnapshots filters;
  const auto base = LabelledSnapshot();
  const auto first = filters.Get(base, LabelledWith("not-0"));
  EXPECT_EQ(first->index.view_count(), 9U);
  const auto second = filters.Get(base, LabelledWith("not-1"));
  EXPECT_EQ(filters.Get(base, LabelledWith("not-0")), first) << "18 copies of 10 views";
  (void)filters.Get(base, LabelledWith("not-2"));
  EXPECT_EQ(filters.Get(base, LabelledWith("not-0")), first) << "used after the second";
  EXPECT_NE(filters.Get(base, LabelledWith("not-1")), second) << "27 copies";
}

TEST(FilteredSnapshotsTest, WhoMeetsAllObjectsGetsTheSnapshotItself) {
  FilteredSnapshots filters;
  const auto base = LabelledSnapshot();
  EXPECT_EQ(filters.Get(base, {}), base);
}

}  // namespace
}  // namespace graspdb::server
