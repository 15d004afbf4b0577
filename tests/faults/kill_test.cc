// kill -9 at random points of a server's work.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "tests/faults/fault_fixture.h"
#include "tests/faults/ledger_check.h"
#include "tests/faults/traffic.h"

namespace graspdb::faults {
namespace {

using std::chrono::microseconds;

constexpr int kRounds = 20;
constexpr std::uint64_t kSeed = 20;
// A round's kill is within this time; in half of the rounds within a quarter of it, in which
// RocksDB compacts what the start has written.
constexpr std::int64_t kLongestUs = 800'000;
// Writes of every second round, which lasts longer for them where the machine is slow. Doubled,
// slow machines take up to twice as long.
constexpr std::int64_t kMinAcknowledged = 10;
constexpr std::chrono::minutes kMaxWait{1};

int Rounds() {
  const char* const rounds = std::getenv("GRASPDB_KILL_ROUNDS");
  return rounds == nullptr ? kRounds : std::atoi(rounds);
}

// What a round interrupted.
struct Interrupted {
  int starts = 0;
  int drains = 0;
  int commits = 0;
  int backups = 0;
  int compactions = 0;
};

class KillTest : public FaultTest {
 protected:
  void Start() { StartServer("db", {"--backup-dir", Path("backups"), "--drain", "1"}); }
  microseconds Moment(int round) {
    const std::int64_t longest = round % 2 == 0 ? kLongestUs : kLongestUs / 4;
    return microseconds(static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(longest)));
  }
  // Kills the server, in some rounds some time after SIGTERM.
  void Kill(int round) {
    if (round % 6 == 5) {
      server_->Signal(SIGTERM);
      std::this_thread::sleep_for(Moment(1));
      ++interrupted_.drains;
    }
    server_->Signal(SIGKILL);
    server_->Wait();
    interrupted_.compactions += CompactionRuns() ? 1 : 0;
  }
  // In some rounds kills a server that starts.
  void KillStart(int round) {
    if (round % 5 != 4) return;
    const end_to_end::Process starting(folder_.path(), ServerCommand(Path("db"), "127.0.0.1:0"));
    std::this_thread::sleep_for(Moment(1) / 2);
    ++interrupted_.starts;
  }
  // Waits until enough writes of this round are acknowledged.
  void AwaitAcknowledged(std::int64_t before, int round) {
    if (round % 2 != 0) return;
    const auto end = std::chrono::steady_clock::now() + kMaxWait;
    while (ledger_.acknowledged() < before + kMinAcknowledged) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << "the server acknowledges nothing";
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  // By RocksDB's own log.
  bool CompactionRuns() const {
    std::ifstream log(Path("db") + "/LOG");
    int running = 0;
    for (std::string line; std::getline(log, line);) {
      running += line.find("\"compaction_started\"") != std::string::npos ? 1 : 0;
      running -= line.find("\"compaction_finished\"") != std::string::npos ? 1 : 0;
    }
    return running > 0;
  }

  Ledger ledger_;
  CheckCounts counts_;
  Interrupted interrupted_;
  std::mt19937_64 random_{kSeed};
};

TEST_F(KillTest, NothingAcknowledgedIsLost) {
  Prepare();
  std::filesystem::create_directory(Path("backups"));
  Start();
  {
    client::Client client = Connect();
    ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  }
  const int rounds = Rounds();
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    {
      const std::int64_t before = ledger_.acknowledged();
      Traffic traffic(address_, samples_, round, ledger_);
      std::this_thread::sleep_for(Moment(round));
      AwaitAcknowledged(before, round);
      interrupted_.commits += traffic.commits() ? 1 : 0;
      interrupted_.backups += traffic.backs_up() ? 1 : 0;
      traffic.ExpectEnd();
      Kill(round);
    }
    KillStart(round);
    Start();
    client::Client client = Connect();
    LedgerCheck(client, samples_, ledger_, counts_).Run(random_, round + 1 == rounds);
  }
  std::printf(
      "%d kills (and %d of a start, %d during a drain); %lld acknowledged writes, %d lost; "
      "%d unanswered writes, %d of them applied; interrupted: %d bulk uploads, %d commits, "
      "%d backups, %d compactions\n",
      rounds, interrupted_.starts, interrupted_.drains,
      static_cast<long long>(ledger_.acknowledged()), counts_.lost, counts_.unanswered,
      counts_.applied, counts_.uploads, interrupted_.commits, interrupted_.backups,
      interrupted_.compactions);
  EXPECT_GE(ledger_.acknowledged(), kMinAcknowledged * rounds / 2);
}

}  // namespace
}  // namespace graspdb::faults
