// Searches of enough views for projections: the same results as comparing with every view.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "recognition/index/descriptor_index.h"
#include "tests/recognition/scenes/similar_histograms.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::kBins;
using ::graspdb::testing::Random;
using ::graspdb::testing::Scaled;
using ::graspdb::testing::Shapes;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::ViewsOf;

constexpr int kViews = 5000;

using Found = std::vector<std::pair<double, std::string>>;

Found All(const std::vector<IndexedView>& views, const Descriptor& query) {
  const DescriptorQuery padded(query);
  Found out;
  for (std::size_t i = 0; i < views.size(); i += 500) {
    const auto some = std::span(views).subspan(i, std::min<std::size_t>(500, views.size() - i));
    const DescriptorChunk chunk(some, nullptr);
    for (std::size_t row = 0; row < some.size(); ++row) {
      out.emplace_back(chunk.Distance(padded, row), some[row].view->name);
    }
  }
  std::ranges::sort(out);
  return out;
}

void ExpectExact(const DescriptorIndex& index, const std::vector<IndexedView>& views,
                 const Descriptor& query) {
  const Found all = All(views, query);
  for (const int count : {1, 10, 600, 6000}) {
    Found found;
    for (const Match& m : index.Nearest(query, count)) found.emplace_back(m.distance, m.view->name);
    const std::size_t wanted = std::min<std::size_t>(static_cast<std::size_t>(count), all.size());
    ASSERT_EQ(found, Found(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(wanted)));
  }
}

bool HasProjections(const DescriptorIndex& index) {
  return std::ranges::all_of(index.chunks(),
                             [](const auto& c) { return c->projection() != nullptr; });
}

Descriptor OneBin(std::size_t bin) {
  Descriptor out(kBins, 0.0F);
  out[bin] = 1;
  return out;
}

class DescriptorIndexExactTest : public ::testing::Test {
 protected:
  Random random_{29};
  Shapes shapes_{random_};
};

TEST_F(DescriptorIndexExactTest, SimilarViews) {
  std::vector<Descriptor> taught(kViews);
  std::ranges::generate(taught, [&] { return shapes_.Next(); });
  const auto views = ViewsOf(taught);
  const DescriptorIndex index = DescriptorIndex(kBins).With(views);
  EXPECT_TRUE(HasProjections(index));
  for (int i = 0; i < 5; ++i) ExpectExact(index, views, shapes_.Next());
  ExpectExact(index, views, taught[77]);
  ExpectExact(index, views, OneBin(3));
  ExpectExact(index, views, Descriptor(kBins, 0.0F));
  ExpectExact(index, views, Descriptor(kBins, 1.0F / kBins));
  ExpectExact(index, views, Descriptor(kBins, 1e30F));
}

TEST_F(DescriptorIndexExactTest, TiesAndEqualViews) {
  std::vector<Descriptor> taught(kViews);
  std::vector<Descriptor> few(40);
  std::ranges::generate(few, [&] { return shapes_.Next(); });
  for (std::size_t i = 0; i < taught.size(); ++i) taught[i] = few[i % few.size()];
  const auto views = ViewsOf(taught);
  const DescriptorIndex index = DescriptorIndex(kBins).With(views);
  ExpectExact(index, views, few[7]);
  ExpectExact(index, views, shapes_.Next());
  const auto equal = ViewsOf(std::vector<Descriptor>(kViews, few[0]));
  ExpectExact(DescriptorIndex(kBins).With(equal), equal, few[0]);
  ExpectExact(DescriptorIndex(kBins).With(equal), equal, few[1]);
}

TEST_F(DescriptorIndexExactTest, IndependentAndOneBinViewsHaveBytesOfAllBins) {
  std::vector<Descriptor> taught;
  for (std::size_t i = 0; i < kViews; ++i) {
    Descriptor bins(kBins);
    for (float& bin : bins) bin = static_cast<float>(std::max(0.0, Uniform(random_, -2, 1)));
    taught.push_back(i % 2 == 0 ? OneBin(i / 2 % kBins) : Scaled(bins));
  }
  const auto views = ViewsOf(taught);
  const DescriptorIndex index = DescriptorIndex(kBins).With(views);
  EXPECT_FALSE(HasProjections(index));
  ExpectExact(index, views, taught[1]);
  ExpectExact(index, views, OneBin(0));
  ExpectExact(index, views, shapes_.Next());
}

TEST_F(DescriptorIndexExactTest, ViewsThatDifferInTheLastDigit) {
  const Descriptor base = shapes_.Next();
  std::vector<Descriptor> taught(kViews, base);
  for (std::size_t i = 0; i < taught.size(); ++i) {
    float& bin = taught[i][i % kBins];
    bin = std::nextafter(bin, i % 2 == 0 ? 1.0F : 0.0F);
    if (i % 3 == 0) taught[i] = shapes_.Next();
  }
  const auto views = ViewsOf(taught);
  const DescriptorIndex index = DescriptorIndex(kBins).With(views);
  EXPECT_TRUE(HasProjections(index));
  ExpectExact(index, views, base);
  ExpectExact(index, views, taught[1]);
}

TEST_F(DescriptorIndexExactTest, ViewsUnlikeTheFittedOnes) {
  std::vector<Descriptor> taught(kViews);
  std::ranges::generate(taught, [&] { return shapes_.Next(); });
  Shapes others(random_);
  std::vector<Descriptor> newcomers(3000);
  std::ranges::generate(newcomers, [&] { return others.Next(); });
  taught.insert(taught.end(), newcomers.begin(), newcomers.end());
  const auto views = ViewsOf(taught);
  const auto first = std::span(views).first(kViews);
  DescriptorIndex index = DescriptorIndex(kBins).With(first).With(std::span(views).subspan(kViews));
  EXPECT_TRUE(HasProjections(index));
  ExpectExact(index, views, others.Next());
  ExpectExact(index, views, shapes_.Next());
  index = index.Without({views[3].view->name});
  auto left = views;
  left.erase(left.begin() + 3);
  ExpectExact(index, left, taught[3]);
}

TEST_F(DescriptorIndexExactTest, JoinedPartsAreCodedAsTheWhole) {
  std::vector<Descriptor> taught(kViews);
  std::ranges::generate(taught, [&] { return shapes_.Next(); });
  const auto views = ViewsOf(taught);
  DescriptorIndex index(kBins);
  for (std::size_t i = 0; i < views.size(); i += 1000) {
    index = index.Joined(index.Empty().With(std::span(views).subspan(i, 1000)));
  }
  EXPECT_TRUE(HasProjections(index));
  EXPECT_EQ(index.view_count(), views.size());
  ExpectExact(index, views, shapes_.Next());
}

}  // namespace
}  // namespace graspdb::recognition
