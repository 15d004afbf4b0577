// An index without the views that a request does not meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "recognition/index/descriptor_index.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::Uniform;

constexpr int kFewBins = 40;
constexpr int kObjects = 23;

Descriptor SparseDescriptor(Random& random) {
  Descriptor out(kFewBins, 0.0F);
  float sum = 0;
  for (float& x : out) {
    x = static_cast<float>(std::max(0.0, Uniform(random, -2, 1)));
    sum += x;
  }
  for (float& x : out) x /= std::max(sum, 1e-6F);
  return out;
}

// Views of objects in turn; the numbers of later ones begin at `first`.
std::vector<IndexedView> ViewsOfObjects(Random& random, int first, int count) {
  std::vector<IndexedView> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = first; i < first + count; ++i) {
    auto view = std::make_shared<TaughtView>();
    view->object = absl::StrFormat("objects/o%d", static_cast<int>(Uniform(random, 0, kObjects)));
    view->name = absl::StrFormat("%s/stablePoses/p/views/%05d", view->object, i);
    out.push_back({view, SparseDescriptor(random)});
  }
  return out;
}

// A random set of objects.
std::set<std::string> SomeObjects(Random& random) {
  const double share = Uniform(random, 0, 1);
  std::set<std::string> out;
  for (int i = 0; i < kObjects; ++i) {
    if (Uniform(random, 0, 1) < share) out.insert(absl::StrFormat("objects/o%d", i));
  }
  return out;
}

std::vector<IndexedView> VisibleViews(const std::vector<IndexedView>& views,
                                      const std::set<std::string>& objects) {
  std::vector<IndexedView> out;
  std::ranges::copy_if(views, std::back_inserter(out), [&](const IndexedView& view) {
    return objects.contains(view.view->object);
  });
  return out;
}

void ExpectSameAnswers(const DescriptorIndex& a, const DescriptorIndex& b, Random& random) {
  ASSERT_EQ(a.view_count(), b.view_count());
  for (const int count : {1, 10, 60}) {
    const Descriptor query = SparseDescriptor(random);
    const std::vector<Match> of_a = a.Nearest(query, count);
    const std::vector<Match> of_b = b.Nearest(query, count);
    ASSERT_EQ(of_a.size(), of_b.size());
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      EXPECT_EQ(of_a[i].view, of_b[i].view);
      EXPECT_EQ(of_a[i].distance, of_b[i].distance) << "bit for bit";
    }
  }
}

TEST(FilteredIndexTest, FindsWhatAnIndexOfTheVisibleViewsFinds) {
  Random random(71);
  for (int round = 0; round < 20; ++round) {
    std::vector<IndexedView> views =
        ViewsOfObjects(random, 0, static_cast<int>(Uniform(random, 1, 2500)));
    DescriptorIndex index = DescriptorIndex(kFewBins).With(views);
    const std::set<std::string> objects = SomeObjects(random);
    const auto is_visible = [&](const TaughtView& view) { return objects.contains(view.object); };
    DescriptorIndex::FilteredChunks known;
    const auto expect_same = [&] {
      const std::vector<IndexedView> visible = VisibleViews(views, objects);
      ExpectSameAnswers(index.Filtered(is_visible, &known), DescriptorIndex(kFewBins).With(visible),
                        random);
    };
    expect_same();
    // After a change, with the chunks of before.
    const std::vector<IndexedView> more = ViewsOfObjects(random, 10'000, 300);
    index = index.With(more).Without({views.front().view->name});
    views.erase(views.begin());
    views.insert(views.end(), more.begin(), more.end());
    expect_same();
    EXPECT_EQ(known.size(), index.chunks().size()) << "only those in use are kept";
  }
}

TEST(FilteredIndexTest, UnchangedChunksAreNotFilteredAgain) {
  Random random(72);
  const std::vector<IndexedView> views = ViewsOfObjects(random, 0, 5 * 512);
  const DescriptorIndex index = DescriptorIndex(kFewBins).With(views);
  int checked = 0;
  const auto is_visible = [&](const TaughtView& view) {
    ++checked;
    return view.object != "objects/o1";
  };
  DescriptorIndex::FilteredChunks known;
  (void)index.Filtered(is_visible, &known);
  EXPECT_EQ(checked, 5 * 512);
  const std::vector<IndexedView> more = ViewsOfObjects(random, 10'000, 100);
  (void)index.With(more).Filtered(is_visible, &known);
  EXPECT_EQ(checked, 5 * 512 + 100);
}

}  // namespace
}  // namespace graspdb::recognition
