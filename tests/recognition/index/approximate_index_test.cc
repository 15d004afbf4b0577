#include "recognition/index/approximate_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "recognition/index/descriptor_index.h"
#include "recognition/index/recall.h"
#include "tests/recognition/similar_histograms.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::kBins;
using ::graspdb::testing::Random;
using ::graspdb::testing::Shapes;
using ::graspdb::testing::StatusIs;
using ::graspdb::testing::ViewsOf;
using ::testing::SizeIs;

// With few checks a search misses some of the nearest.
constexpr ApproximateIndex::SearchParameters kFew = {40, 15};
constexpr ApproximateIndex::SearchParameters kMany = {4096, 500};

using Found = std::vector<std::pair<double, std::string>>;

Found NearestOf(const DescriptorIndex& index, const Descriptor& query, int count) {
  Found out;
  for (const Match& m : index.Nearest(query, count)) out.emplace_back(m.distance, m.view->name);
  return out;
}

class ApproximateIndexTest : public ::testing::Test {
 protected:
  ApproximateIndexTest() {
    std::vector<Descriptor> taught(6000);
    std::ranges::generate(taught, [&] { return shapes_.Next(); });
    views_ = ViewsOf(taught);
    exact_ = exact_.With(views_);
  }

  DescriptorIndex Approximate(const ApproximateIndex::SearchParameters& search) {
    const auto made = ApproximateIndex::Build(exact_.chunks(), search);
    EXPECT_THAT(made, IsOk());
    return made.ok() ? exact_.WithApproximate(*made) : exact_;
  }

  // As after a restart: other views of the same names, and some deleted meanwhile.
  static DescriptorIndex Reloaded(const ApproximateIndex& index, const DescriptorIndex& now) {
    const auto saved = index.Save();
    EXPECT_THAT(saved, IsOk());
    std::vector<IndexedView> views;
    for (const auto& chunk : now.chunks()) {
      for (std::size_t row = 0; row < chunk->size(); ++row) {
        const auto view = std::make_shared<TaughtView>(*chunk->views()[row]);
        views.push_back({view, chunk->DescriptorOf(row)});
      }
    }
    std::ranges::sort(views, {}, [](const IndexedView& v) { return v.view->name; });
    const DescriptorIndex fresh = DescriptorIndex(kBins).With(views);
    std::vector<ApproximateIndex::Place> places(index.places().size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& old = index.places()[i];
      for (const auto& chunk : fresh.chunks()) {
        for (std::size_t row = 0; row < chunk->size(); ++row) {
          if (chunk->views()[row]->name == old.chunk->views()[old.row]->name) {
            places[i] = {chunk.get(), row};
          }
        }
      }
    }
    const auto chunks = fresh.chunks();
    const auto loaded = ApproximateIndex::Load(*saved, places, {chunks.begin(), chunks.end()});
    EXPECT_THAT(loaded, IsOk());
    return loaded.ok() ? fresh.WithApproximate(*loaded) : fresh;
  }

  Random random_{31};
  Shapes shapes_{random_};
  std::vector<IndexedView> views_;
  DescriptorIndex exact_{kBins};
};

TEST_F(ApproximateIndexTest, FindsNearlyAllAndRanksThemByTheExactDistance) {
  const auto index = WithNewApproximate(exact_);
  ASSERT_THAT(index, IsOk());
  EXPECT_GE(index->approximate()->recall_at_10(), 0.99);
  EXPECT_EQ(index->newer_view_count(), 0U);
  std::size_t hits = 0;
  for (int i = 0; i < 20; ++i) {
    const Descriptor query = shapes_.Next();
    const Found all = NearestOf(exact_, query, 6000);
    const Found found = NearestOf(*index, query, 10);
    ASSERT_THAT(found, SizeIs(10));
    EXPECT_TRUE(std::ranges::is_sorted(found));
    for (const auto& match : found) {
      EXPECT_TRUE(std::ranges::binary_search(all, match));
      hits += match <= all[9] ? 1U : 0U;
    }
  }
  EXPECT_GE(hits, 190U);
}

TEST_F(ApproximateIndexTest, MoreNeighborsAreFoundExactly) {
  const DescriptorIndex index = Approximate(kFew);
  const Descriptor query = shapes_.Next();
  EXPECT_EQ(NearestOf(index, query, 51), NearestOf(exact_, query, 51));
  EXPECT_EQ(NearestOf(index, query, 600), NearestOf(exact_, query, 600));
}

TEST_F(ApproximateIndexTest, ALoadedIndexAnswersAsTheSavedOne) {
  const DescriptorIndex index = Approximate(kFew);
  const DescriptorIndex loaded = Reloaded(*index.approximate(), exact_);
  bool differs_from_exact = false;
  for (int i = 0; i < 40; ++i) {
    const Descriptor query = shapes_.Next();
    const Found before = NearestOf(index, query, 10);
    EXPECT_EQ(NearestOf(loaded, query, 10), before);
    differs_from_exact |= before != NearestOf(exact_, query, 10);
  }
  EXPECT_TRUE(differs_from_exact);
}

TEST_F(ApproximateIndexTest, ALoadedIndexAnswersAsTheSavedOneAfterChanges) {
  std::unordered_set<std::string> names;
  for (std::size_t i = 0; i < views_.size(); i += 3) names.insert(views_[i].view->name);
  std::vector<Descriptor> more(700);
  std::ranges::generate(more, [&] { return shapes_.Next(); });
  std::vector<IndexedView> newer;
  for (std::size_t i = 0; i < more.size(); ++i) {
    auto view = std::make_shared<TaughtView>();
    view->name = "newer-" + std::to_string(i);
    newer.push_back({std::move(view), more[i]});
  }
  const DescriptorIndex index = Approximate(kFew).Without(names).With(newer);
  EXPECT_EQ(index.newer_view_count(), 700U);
  EXPECT_EQ(index.deleted_view_count(), names.size());
  const DescriptorIndex loaded = Reloaded(*index.approximate(), index);
  EXPECT_EQ(loaded.newer_view_count(), 700U);
  EXPECT_EQ(loaded.deleted_view_count(), names.size());
  EXPECT_EQ(loaded.view_count(), index.view_count());
  for (int i = 0; i < 40; ++i) {
    const Descriptor query = shapes_.Next();
    const Found before = NearestOf(index, query, 10);
    ASSERT_THAT(before, SizeIs(10));
    EXPECT_EQ(NearestOf(loaded, query, 10), before);
    for (const auto& [distance, name] : before) EXPECT_FALSE(names.contains(name)) << name;
  }
  EXPECT_EQ(index.Nearest(more[5], 1)[0].view, newer[5].view);
}

TEST_F(ApproximateIndexTest, ARetaughtViewIsFoundWithItsNewDescriptor) {
  const IndexedView& old = views_[17];
  auto again = std::make_shared<TaughtView>(*old.view);
  const Descriptor descriptor = shapes_.Next();
  const DescriptorIndex index = Approximate(kMany)
                                    .Without({old.view->name})
                                    .With(std::vector<IndexedView>{{again, descriptor}});
  EXPECT_EQ(index.view_count(), views_.size());
  EXPECT_EQ(index.Nearest(descriptor, 1)[0].view, again);
  EXPECT_GT(index.Nearest(old.descriptor, 1)[0].distance, 0);
}

TEST_F(ApproximateIndexTest, NoViewIsFoundAfterAllAreDeleted) {
  std::unordered_set<std::string> names;
  for (const IndexedView& v : views_) names.insert(v.view->name);
  const DescriptorIndex none = Approximate(kMany).Without(names);
  EXPECT_EQ(none.view_count(), 0U);
  EXPECT_THAT(none.Nearest(shapes_.Next(), 10), ::testing::IsEmpty());
}

TEST_F(ApproximateIndexTest, EqualViewsAreFoundByName) {
  const auto equal = ViewsOf(std::vector<Descriptor>(300, shapes_.Next()));
  std::vector<IndexedView> views(views_.begin(), views_.begin() + 2000);
  for (const IndexedView& v : equal) {
    auto view = std::make_shared<TaughtView>();
    view->name = "a-" + v.view->name;
    views.push_back({std::move(view), v.descriptor});
  }
  const auto index = WithNewApproximate(DescriptorIndex(kBins).With(views));
  ASSERT_THAT(index, IsOk());
  const DescriptorIndex exact = index->WithApproximate(nullptr);
  const Descriptor& query = equal.front().descriptor;
  EXPECT_EQ(NearestOf(*index, query, 10), NearestOf(exact, query, 10));
}

TEST_F(ApproximateIndexTest, TooFewViewsAndOtherLibrariesAreRejected) {
  const DescriptorIndex few = DescriptorIndex(kBins).With(std::span(views_).first(20));
  EXPECT_THAT(ApproximateIndex::Build(few.chunks(), kMany),
              StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(ApproximateIndex::Build({}, kMany), StatusIs(absl::StatusCode::kFailedPrecondition));
  auto saved = Approximate(kMany).approximate()->Save();
  ASSERT_THAT(saved, IsOk());
  const std::vector<ApproximateIndex::Place> places(views_.size());
  EXPECT_THAT(ApproximateIndex::Load(*saved, {places.begin(), places.begin() + 5}, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition));
  for (const auto& search : {ApproximateIndex::SearchParameters{0, 15}, {40, -1}, {40, 1 << 30}}) {
    auto with = *saved;
    with.search = search;
    EXPECT_THAT(ApproximateIndex::Load(with, places, {}),
                StatusIs(absl::StatusCode::kFailedPrecondition));
  }
  saved->library = "FLANN 1.8";
  EXPECT_THAT(ApproximateIndex::Load(*saved, places, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition));
}

}  // namespace
}  // namespace graspdb::recognition
