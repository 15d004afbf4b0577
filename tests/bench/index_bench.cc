// The nearest of thousands of descriptors.
#include <benchmark/benchmark.h>
#include <faiss/IndexFlat.h>
#include <hnswlib/hnswlib.h>

#include <algorithm>
#include <flann/flann.hpp>
#include <memory>
#include <numeric>
#include <random>
#include <set>

#include "recognition/index/descriptor_index.h"
#include "tests/bench/catalogue.h"
#include "tests/bench/suite.h"
#include "tests/recognition/scenes/chi_square.h"

namespace graspdb::bench {
namespace {

using recognition::Descriptor;
using recognition::DescriptorIndex;

constexpr int kCount = 10;
constexpr std::size_t kQueries = 64;
constexpr std::size_t kBins = 288;
// Building a larger graph takes minutes.
constexpr std::size_t kMaxForGraph = 10'000;
// For more views, the copies for other libraries take too much memory.
constexpr std::size_t kMaxForPeers = 100'000;
constexpr std::size_t kMaxWithClouds = 100'000;

// Descriptors of the catalogue, and queries: some of them with a part of the mass moved to other
// bins.
struct Rows {
  std::vector<float> values;
  std::vector<Descriptor> queries;
  DescriptorIndex index{static_cast<int>(kBins)};
  std::size_t count = 0;
};

// The same with a part of the mass moved to other bins.
Descriptor Blurred(Descriptor descriptor, std::mt19937_64* random) {
  for (float& bin : descriptor) {
    bin *= 0.7F + 0.6F * static_cast<float>((*random)() % 1000) / 1000.0F;
  }
  const float sum = std::accumulate(descriptor.begin(), descriptor.end(), 0.0F);
  for (float& bin : descriptor) bin /= sum;
  return descriptor;
}

// Descriptors of a catalogue of this many views; beyond the limit with clouds, those of a smaller
// one, blurred.
Rows RowsOf(std::size_t count) {
  Rows out;
  const Catalogue catalogue(std::min(count, kMaxWithClouds));
  out.count = count;
  std::mt19937_64 random(3);
  std::vector<recognition::IndexedView> views;
  views.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const TaughtCloud& taught = catalogue.views()[i % catalogue.views().size()];
    auto view = std::make_shared<recognition::TaughtView>();
    view->name = std::to_string(i);
    const bool is_new = i < catalogue.views().size();
    views.push_back(
        {std::move(view), is_new ? taught.descriptor : Blurred(taught.descriptor, &random)});
  }
  for (const auto& v : views) {
    out.values.insert(out.values.end(), v.descriptor.begin(), v.descriptor.end());
  }
  for (std::size_t q = 0; q < kQueries; ++q) {
    out.queries.push_back(Blurred(views[random() % count].descriptor, &random));
  }
  out.index = out.index.With(views);
  return out;
}

// Recall of the true nearest in `found`, for one query.
double Recall(const Rows& rows, const Descriptor& query, const std::set<std::size_t>& found) {
  std::vector<std::pair<double, std::size_t>> all(rows.count);
  Descriptor row(kBins);
  for (std::size_t i = 0; i < rows.count; ++i) {
    std::copy_n(rows.values.begin() + static_cast<std::ptrdiff_t>(i * kBins), kBins, row.begin());
    all[i] = {testing::ChiSquareDistance(query, row), i};
  }
  std::partial_sort(all.begin(), all.begin() + kCount, all.end());
  double hits = 0;
  for (int i = 0; i < kCount; ++i) hits += found.contains(all[static_cast<std::size_t>(i)].second);
  return hits / kCount;
}

// Returns the positions of the nearest.
using SearchFor = std::function<std::set<std::size_t>(const Descriptor&)>;

void Add(const std::string& work, const std::string& program, const Lazy<Rows>& rows,
         const Lazy<SearchFor>& search) {
  Compare(work, program, [=](benchmark::State& state) {
    const SearchFor& nearest = *search;
    std::size_t next = 0;
    {
      const Counted counted;
      for (auto _ : state) {
        benchmark::DoNotOptimize(nearest(rows->queries[next]));
        next = (next + 1) % kQueries;
      }
    }
    double recall = 0;
    for (std::size_t q = 0; q < 8; ++q) {
      recall += Recall(*rows, rows->queries[q], nearest(rows->queries[q])) / 8;
    }
    state.counters["recall_at_10"] = recall;
  });
}

std::size_t PositionOf(const recognition::Match& match) { return std::stoul(match.view->name); }

SearchFor OursExact(const Rows& rows) {
  return [&rows](const Descriptor& query) {
    std::set<std::size_t> out;
    for (const auto& match : rows.index.Nearest(query, kCount)) out.insert(PositionOf(match));
    return out;
  };
}

SearchFor Flann(const Rows& rows, const flann::IndexParams& kind, int checks) {
  const auto index = std::make_shared<flann::Index<flann::ChiSquareDistance<float>>>(
      flann::Matrix<float>(const_cast<float*>(rows.values.data()), rows.count, kBins), kind);
  index->buildIndex();
  return [index, checks](const Descriptor& query) {
    std::vector<std::vector<int>> found;
    std::vector<std::vector<float>> distances;
    index->knnSearch(flann::Matrix<float>(const_cast<float*>(query.data()), 1, kBins), found,
                     distances, kCount, flann::SearchParams(checks));
    return std::set<std::size_t>(found.front().begin(), found.front().end());
  };
}

// faiss and hnswlib use Euclidean distance; on square roots of histograms it is Hellinger's, which
// is close to chi-square.
std::vector<float> Roots(std::vector<float> bins) {
  for (float& bin : bins) bin = std::sqrt(bin);
  return bins;
}

SearchFor Faiss(const Rows& rows) {
  const auto flat = std::make_shared<faiss::IndexFlatL2>(kBins);
  flat->add(static_cast<faiss::Index::idx_t>(rows.count), Roots(rows.values).data());
  return [flat](const Descriptor& query) {
    std::vector<float> distances(kCount);
    std::vector<faiss::Index::idx_t> found(kCount);
    flat->search(1, Roots(query).data(), kCount, distances.data(), found.data());
    return std::set<std::size_t>(found.begin(), found.end());
  };
}

SearchFor Hnsw(const Rows& rows) {
  const auto space = std::make_shared<hnswlib::L2Space>(kBins);
  const auto graph = std::make_shared<hnswlib::HierarchicalNSW<float>>(space.get(), rows.count);
  const std::vector<float> roots = Roots(rows.values);
  for (std::size_t i = 0; i < rows.count; ++i) graph->addPoint(roots.data() + i * kBins, i);
  graph->setEf(64);
  return [graph, space](const Descriptor& query) {
    auto found = graph->searchKnn(Roots(query).data(), kCount);
    std::set<std::size_t> out;
    for (; !found.empty(); found.pop()) out.insert(found.top().second);
    return out;
  };
}

void AddSize(std::size_t count) {
  const Lazy<Rows> rows([=] { return RowsOf(count); });
  const std::string work = "nearest 10 of " + std::to_string(count) + " views";
  const auto add = [&](const std::string& program,
                       const std::function<SearchFor(const Rows&)>& make) {
    Add(work, program, rows, Lazy<SearchFor>([=] { return make(*rows); }));
  };
  add("graspdb", OursExact);
  add("FLANN linear", [](const Rows& r) { return Flann(r, flann::LinearIndexParams(), -1); });
  if (count > kMaxForPeers) return;
  add("FLANN kd-forest", [](const Rows& r) { return Flann(r, flann::KDTreeIndexParams(4), 128); });
  add("faiss flat, Hellinger", Faiss);
  if (count <= kMaxForGraph) add("hnswlib, Hellinger", Hnsw);
}

}  // namespace

void AddIndex() {
  for (const std::size_t count : {1'000U, 10'000U, 100'000U, 1'000'000U}) AddSize(count);
}

}  // namespace graspdb::bench
