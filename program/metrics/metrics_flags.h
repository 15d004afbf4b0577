// Flags of programs with metrics.
#pragma once

#include <CLI/CLI.hpp>

#include "program/metrics/metrics_server.h"

namespace graspdb {

inline void AddMetricsFlags(CLI::App& app, MetricsOptions* options) {
  app.add_option("--metrics-listen", options->listen,
                 "HOST:PORT for metrics over HTTP, for Prometheus; by default there are none");
  app.add_flag("--allow-remote-metrics", options->allow_remote,
               "Allow addresses for metrics that other machines can reach, unencrypted");
}

}  // namespace graspdb
