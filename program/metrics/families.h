// Metrics in Prometheus' data model (https://prometheus.io/docs/concepts/metric_types/).
#pragma once

#include <prometheus/counter.h>
#include <prometheus/histogram.h>
#include <prometheus/metric_family.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace graspdb {

using MetricFamilies = std::vector<prometheus::MetricFamily>;

// A value that is read when the metrics are collected.
struct Sample {
  double value = 0;
  std::vector<prometheus::ClientMetric::Label> labels = {};
};

// A metric of such values. `samples` may be empty: nothing is known.
prometheus::MetricFamily GaugeOf(std::string name, std::string help, std::vector<Sample> samples);
prometheus::MetricFamily CounterOf(std::string name, std::string help, std::vector<Sample> samples);

// A metric of events, `Metric` being prometheus::Counter or prometheus::Histogram, with one series
// for each combination of label values. Thread-safe.
template <typename Metric>
class EventFamily {
 public:
  // Names of objects and cells are label values, so that the number of series is limited. 4,096
  // counters take 1 MiB.
  static constexpr std::size_t kMaxSeries = 4096;

  // `bounds`: upper ends of a histogram's buckets, ascending.
  EventFamily(std::string name, std::string help, std::vector<std::string> labels,
              std::vector<double> bounds = {})
      : name_(std::move(name)),
        help_(std::move(help)),
        labels_(std::move(labels)),
        bounds_(std::move(bounds)) {}

  // The series with these values of the labels; beyond the limit one whose values are all "other".
  Metric& With(std::vector<std::string> values) {
    const std::lock_guard lock(mutex_);
    if (series_.size() >= kMaxSeries && !series_.contains(values)) {
      std::ranges::fill(values, "other");
    }
    if constexpr (Metric::metric_type == prometheus::MetricType::Histogram) {
      return series_.try_emplace(std::move(values), bounds_).first->second;
    } else {
      return series_.try_emplace(std::move(values)).first->second;
    }
  }

  prometheus::MetricFamily Collect() const {
    prometheus::MetricFamily out{name_, help_, Metric::metric_type, {}};
    const std::lock_guard lock(mutex_);
    for (const auto& [values, metric] : series_) {
      prometheus::ClientMetric& sample = out.metric.emplace_back(metric.Collect());
      for (std::size_t i = 0; i < labels_.size(); ++i) {
        sample.label.push_back({labels_[i], values[i]});
      }
    }
    return out;
  }

 private:
  const std::string name_;
  const std::string help_;
  const std::vector<std::string> labels_;
  const std::vector<double> bounds_;
  mutable std::mutex mutex_;
  std::map<std::vector<std::string>, Metric> series_;  // its nodes stay where they are
};

using CounterFamily = EventFamily<prometheus::Counter>;
using HistogramFamily = EventFamily<prometheus::Histogram>;

// Bounds of a histogram of durations, seconds: a millisecond to half a minute, 1, 2, 5 and so on.
std::vector<double> DurationBounds();

}  // namespace graspdb
