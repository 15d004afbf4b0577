#include "program/metrics/families.h"

namespace graspdb {
namespace {

prometheus::ClientMetric SampleOf(Sample sample, prometheus::MetricType type) {
  prometheus::ClientMetric out;
  out.label = std::move(sample.labels);
  if (type == prometheus::MetricType::Counter) {
    out.counter.value = sample.value;
  } else {
    out.gauge.value = sample.value;
  }
  return out;
}

prometheus::MetricFamily FamilyOf(prometheus::MetricType type, std::string name, std::string help,
                                  std::vector<Sample> samples) {
  prometheus::MetricFamily out{std::move(name), std::move(help), type, {}};
  out.metric.reserve(samples.size());
  for (Sample& sample : samples) out.metric.push_back(SampleOf(std::move(sample), type));
  return out;
}

}  // namespace

prometheus::MetricFamily GaugeOf(std::string name, std::string help, std::vector<Sample> samples) {
  return FamilyOf(prometheus::MetricType::Gauge, std::move(name), std::move(help),
                  std::move(samples));
}

prometheus::MetricFamily CounterOf(std::string name, std::string help,
                                   std::vector<Sample> samples) {
  return FamilyOf(prometheus::MetricType::Counter, std::move(name), std::move(help),
                  std::move(samples));
}

std::vector<double> DurationBounds() {
  return {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30};
}

}  // namespace graspdb
