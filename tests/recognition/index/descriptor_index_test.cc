#include "recognition/index/descriptor_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <unordered_set>

#include "absl/strings/str_format.h"
#include "tests/recognition/scenes/chi_square.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::ChiSquareDistance;
using ::graspdb::testing::Random;
using ::graspdb::testing::Uniform;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kMvfhBins = 300;

IndexedView View(const std::string& name, Descriptor descriptor) {
  auto view = std::make_shared<TaughtView>();
  view->name = name;
  return {view, std::move(descriptor)};
}

// Sparse like real ones: most bins are zero.
Descriptor RandomDescriptor(Random& random) {
  Descriptor out(kMvfhBins, 0.0F);
  double sum = 0;
  for (float& x : out) {
    const double value = Uniform(random, -2, 1);
    x = value > 0 ? static_cast<float>(value) : 0.0F;
    sum += x;
  }
  for (float& x : out) x = static_cast<float>(x / sum);
  return out;
}

std::vector<IndexedView> RandomViews(Random& random, int count) {
  std::vector<IndexedView> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    out.push_back(
        View(absl::StrFormat("objects/o%d/views/%04d", i % 7, i), RandomDescriptor(random)));
  }
  return out;
}

DescriptorIndex IndexOf(const std::vector<IndexedView>& views) {
  return DescriptorIndex(kMvfhBins).With(views);
}

std::vector<std::string> Names(const std::vector<Match>& matches) {
  std::vector<std::string> out;
  out.reserve(matches.size());
  for (const Match& m : matches) out.push_back(m.view->name);
  return out;
}

void ExpectNearest(const DescriptorIndex& index, const std::vector<IndexedView>& views,
                   const Descriptor& query, std::size_t count) {
  std::vector<double> truth;
  truth.reserve(views.size());
  for (const IndexedView& v : views) truth.push_back(ChiSquareDistance(query, v.descriptor));
  std::sort(truth.begin(), truth.end());
  const std::vector<Match> found = index.Nearest(query, static_cast<int>(count));
  ASSERT_THAT(found, SizeIs(std::min(count, views.size())));
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].distance, truth[i], 2e-6);
    const auto same = std::ranges::find(views, found[i].view, &IndexedView::view);
    ASSERT_NE(same, views.end());
    EXPECT_NEAR(ChiSquareDistance(query, same->descriptor), found[i].distance, 2e-6);
  }
}

TEST(DescriptorIndexTest, NearestAgreeWithBruteForceOverSeveralChunks) {
  Random random(41);
  for (const int count : {1, 511, 512, 513, 1300}) {
    const std::vector<IndexedView> views = RandomViews(random, count);
    const DescriptorIndex index = IndexOf(views);
    EXPECT_EQ(index.view_count(), views.size());
    for (int i = 0; i < 10; ++i) ExpectNearest(index, views, RandomDescriptor(random), 10);
    ExpectNearest(index, views, views.back().descriptor, 1);
  }
}

TEST(DescriptorIndexTest, StoredDescriptorFindsItselfAtZero) {
  Random random(42);
  const std::vector<IndexedView> views = RandomViews(random, 600);
  const DescriptorIndex index = IndexOf(views);
  for (const std::size_t i : {0U, 300U, 511U, 512U, 599U}) {
    const std::vector<Match> found = index.Nearest(views[i].descriptor, 2);
    EXPECT_EQ(found[0].view, views[i].view);
    EXPECT_EQ(found[0].distance, 0);
    EXPECT_GT(found[1].distance, 0);
  }
}

TEST(DescriptorIndexTest, InsertionOrderDoesNotMatter) {
  Random random(43);
  std::vector<IndexedView> views = RandomViews(random, 700);
  const DescriptorIndex whole = IndexOf(views);
  std::shuffle(views.begin(), views.end(), random);
  DescriptorIndex one_by_one(kMvfhBins);
  for (const IndexedView& v : views) one_by_one = one_by_one.With(std::span(&v, 1));
  for (int i = 0; i < 10; ++i) {
    const Descriptor query = RandomDescriptor(random);
    const std::vector<Match> a = whole.Nearest(query, 25);
    const std::vector<Match> b = one_by_one.Nearest(query, 25);
    EXPECT_EQ(Names(a), Names(b));
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].distance, b[k].distance);
  }
}

TEST(DescriptorIndexTest, JoinedIndicesFindTheSameAsOneOfAllViews) {
  Random random(17);
  const std::vector<IndexedView> views = RandomViews(random, 1500);
  const std::span<const IndexedView> all(views);
  const DescriptorIndex joined = DescriptorIndex(kMvfhBins)
                                     .With(all.first(700))
                                     .Joined(DescriptorIndex(kMvfhBins).With(all.subspan(700)));
  EXPECT_EQ(joined.view_count(), views.size());
  const Descriptor query = RandomDescriptor(random);
  EXPECT_EQ(Names(joined.Nearest(query, 20)), Names(IndexOf(views).Nearest(query, 20)));
}

TEST(DescriptorIndexTest, EqualDistancesComeByName) {
  Random random(44);
  const Descriptor same = RandomDescriptor(random);
  const DescriptorIndex index =
      IndexOf({View("c", same), View("a", same), View("d", same), View("b", same)});
  const Descriptor query = RandomDescriptor(random);
  EXPECT_THAT(Names(index.Nearest(query, 4)), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(Names(index.Nearest(query, 2)), ElementsAre("a", "b"));
}

TEST(DescriptorIndexTest, EqualDistancesComeByNameAcrossChunks) {
  Random random(45);
  const Descriptor same = RandomDescriptor(random);
  std::vector<IndexedView> views;
  for (int i = 1200; i > 0; --i) views.push_back(View(absl::StrFormat("%04d", i), same));
  EXPECT_THAT(Names(IndexOf(views).Nearest(RandomDescriptor(random), 3)),
              ElementsAre("0001", "0002", "0003"));
}

TEST(DescriptorIndexTest, WritesDoNotChangeEarlierSnapshots) {
  Random random(46);
  const std::vector<IndexedView> views = RandomViews(random, 600);
  const DescriptorIndex before = IndexOf(views);
  const IndexedView added = View("new", RandomDescriptor(random));
  const DescriptorIndex with = before.With(std::span(&added, 1));
  const DescriptorIndex without = before.Without({views[5].view->name});

  ExpectNearest(before, views, RandomDescriptor(random), 600);
  EXPECT_EQ(before.view_count(), 600U);
  EXPECT_GT(before.Nearest(added.descriptor, 1)[0].distance, 0);
  EXPECT_EQ(before.Nearest(views[5].descriptor, 1)[0].view, views[5].view);
  EXPECT_EQ(with.Nearest(added.descriptor, 1)[0].view, added.view);
  EXPECT_EQ(with.view_count(), 601U);
  EXPECT_NE(without.Nearest(views[5].descriptor, 1)[0].view, views[5].view);
  EXPECT_EQ(without.view_count(), 599U);
}

TEST(DescriptorIndexTest, ViewsAreRemovedFromEveryChunk) {
  Random random(47);
  std::vector<IndexedView> views = RandomViews(random, 1100);
  const DescriptorIndex whole = IndexOf(views);
  std::unordered_set<std::string> names = {"objects/none"};
  for (std::size_t i = 0; i < views.size(); i += 7) names.insert(views[i].view->name);
  const DescriptorIndex fewer = whole.Without(names);
  std::erase_if(views, [&](const IndexedView& v) { return names.contains(v.view->name); });
  EXPECT_EQ(fewer.view_count(), views.size());
  ExpectNearest(fewer, views, RandomDescriptor(random), 2000);

  // Views added after a removal are found, too.
  const std::vector<IndexedView> more = {View("a", RandomDescriptor(random)),
                                         View("b", RandomDescriptor(random))};
  views.insert(views.end(), more.begin(), more.end());
  ExpectNearest(fewer.With(more), views, RandomDescriptor(random), 2000);
}

TEST(DescriptorIndexTest, RemovingUnknownNamesChangesNothing) {
  Random random(48);
  const std::vector<IndexedView> views = RandomViews(random, 20);
  EXPECT_EQ(IndexOf(views).Without({"objects/none", "objects"}).view_count(), 20U);
  EXPECT_EQ(IndexOf(views).Without({}).view_count(), 20U);
}

TEST(DescriptorIndexTest, WithoutAllViewsTheIndexIsEmpty) {
  Random random(51);
  const std::vector<IndexedView> views = RandomViews(random, 2);
  const DescriptorIndex none = IndexOf(views).Without({views[0].view->name, views[1].view->name});
  EXPECT_EQ(none.view_count(), 0U);
  EXPECT_THAT(none.Nearest(views[0].descriptor, 3), IsEmpty());
}

TEST(DescriptorIndexTest, CountLargerThanTheIndexGivesAll) {
  Random random(49);
  const std::vector<IndexedView> views = RandomViews(random, 5);
  EXPECT_THAT(IndexOf(views).Nearest(RandomDescriptor(random), 50), SizeIs(5));
}

TEST(DescriptorIndexTest, NoMatchesForAnEmptyIndexAWrongLengthOrNoCount) {
  Random random(50);
  const DescriptorIndex index = IndexOf(RandomViews(random, 5));
  EXPECT_THAT(DescriptorIndex(kMvfhBins).Nearest(RandomDescriptor(random), 5), IsEmpty());
  EXPECT_THAT(index.Nearest(Descriptor(263, 0.1F), 5), IsEmpty());
  EXPECT_THAT(index.Nearest({}, 5), IsEmpty());
  EXPECT_THAT(index.Nearest(RandomDescriptor(random), 0), IsEmpty());
  EXPECT_THAT(index.Nearest(RandomDescriptor(random), -1), IsEmpty());
}

}  // namespace
}  // namespace graspdb::recognition
