// graspdb_flood HOST:PORT: many clients send messages of the largest size at once, while a robot
// program sends small frames. Prints status codes, latencies and the server's resident memory.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "client/sdk/client.h"
#include "files/messages/scan_message.h"
#include "recognition/base/types.h"

namespace graspdb::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Deadlines of a robot program and of a batch client.
constexpr absl::Duration kFrameTimeout = absl::Seconds(10);
constexpr absl::Duration kFloodTimeout = absl::Seconds(60);
constexpr std::chrono::milliseconds kBetweenFrames{20};

client::Client Connect(const std::string& server) {
  return client::Client({.server = server, .busy_retries = 0, .own_connection = true});
}

// A segmented cloud of `bytes` bytes whose points coincide.
v1::RecognizeRequest CloudOf(std::size_t bytes) {
  const recognition::Points points(bytes / sizeof(Eigen::Vector3f), {0.1F, 0.1F, 0.6F});
  v1::RecognizeRequest out;
  *out.mutable_cloud() = files::CloudMessage(points, 0);
  out.set_segmented(true);
  return out;
}

// Latencies of the calls by their status code.
class Outcomes {
 public:
  void Add(const absl::Status& status, double ms) {
    const std::scoped_lock lock(mutex_);
    const std::string code = absl::StatusCodeToString(status.code());
    times_[code].push_back(ms);
    if (!status.ok()) messages_.insert({code, std::string(status.message())});
  }

  void Print(const char* name) {
    for (auto& [outcome, times] : times_) {
      std::ranges::sort(times);
      std::printf("| %s | %s | %zu | %.0f | %.0f |\n", name, outcome.c_str(), times.size(),
                  times[times.size() / 2], times.back());
    }
    for (const auto& [code, message] : messages_) {
      std::fprintf(stderr, "%s, %s: %s\n", name, code.c_str(), message.substr(0, 120).c_str());
    }
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::vector<double>> times_;
  std::map<std::string, std::string> messages_;  // one of each kind
};

void SendTimed(client::Client& server, const v1::RecognizeRequest& request, absl::Duration timeout,
               Outcomes* outcomes) {
  const auto start = Clock::now();
  const absl::Status status = server.Recognize(request, timeout).status();
  outcomes->Add(status, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
}

void Flood(const std::string& server, int clients, std::size_t bytes, int rounds) {
  const v1::RecognizeRequest large = CloudOf(bytes);
  const v1::RecognizeRequest frame = CloudOf(10'000);
  Outcomes floods;
  Outcomes frames;
  std::atomic<bool> done = false;
  std::int64_t max_bytes = 0;
  std::thread watch([&] {
    client::Client client = Connect(server);
    while (!done) {
      if (const auto status = client.GetCatalogStatus(); status.ok()) {
        max_bytes = std::max(max_bytes, status->memory().resident_byte_count());
      }
      std::this_thread::sleep_for(kBetweenFrames);
    }
  });
  std::thread robot([&] {
    client::Client client = Connect(server);
    while (!done) {
      SendTimed(client, frame, kFrameTimeout, &frames);
      std::this_thread::sleep_for(kBetweenFrames);
    }
  });
  std::vector<std::thread> flood;
  flood.reserve(static_cast<std::size_t>(clients));
  for (int i = 0; i < clients; ++i) {
    flood.emplace_back([&] {
      client::Client client = Connect(server);
      for (int round = 0; round < rounds; ++round) SendTimed(client, large, kFloodTimeout, &floods);
    });
  }
  for (std::thread& client : flood) client.join();
  done = true;
  robot.join();
  watch.join();
  std::printf(
      "| call | ended with | calls | ms, median | longest |\n| --- | --- | --- | --- | --- |\n");
  floods.Print("large");
  frames.Print("robot's frame");
  std::printf("\nResident, at most: %.0f MiB.\n", static_cast<double>(max_bytes) / (1 << 20));
}

}  // namespace
}  // namespace graspdb::bench

int main(int argc, char** argv) {
  CLI::App app(
      "graspdb_flood sends large messages to a server from many clients at once and small frames "
      "of a robot program meanwhile. It prints status codes, latencies and resident memory.",
      "graspdb_flood");
  std::string server;
  app.add_option("SERVER", server, "HOST:PORT")->required();
  int clients = 64;
  app.add_option("--clients", clients, "Number of clients, each with its own connection")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  int mb = 60;
  app.add_option("--mb", mb, "Size of a message, 10^6 bytes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  int rounds = 1;
  app.add_option("--rounds", rounds, "Messages per client, sent in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  graspdb::bench::Flood(server, clients, static_cast<std::size_t>(mb) * 1'000'000, rounds);
  return 0;
}
