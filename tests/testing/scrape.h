// Metrics as Prometheus reads them.
#pragma once

#include <map>
#include <string>

namespace graspdb::testing {

// The response to GET `path` of HOST:PORT, with its headers; empty without one.
std::string HttpGet(const std::string& address, const std::string& path);

// A metric without its values.
struct MetricText {
  std::string type;
  std::string help;
  bool operator==(const MetricText&) const = default;
};

// The metrics of a response in the text format, by name.
std::map<std::string, MetricText> MetricsIn(const std::string& response);

// Those in the tables of docs/metrics.md, below the heading `section`: the rows
// "| `name` | type | labels | help |".
std::map<std::string, MetricText> MetricsInDocument(const std::string& path,
                                                    const std::string& section);

// The value of a series such as `graspdb_calls_total{method="GetCell",code="OK"}`; -1 without it.
double ValueOf(const std::string& response, const std::string& series);

}  // namespace graspdb::testing
