// Calls of all kinds at the same time, until their server is gone.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/faults/ledger.h"
#include "tests/faults/sample_views.h"

namespace graspdb::faults {

// Single uploads, deletions, bulk uploads of several streams with their commits, and backups, each
// on threads of its own, which note in the ledger what the server acknowledged.
class Traffic {
 public:
  // All must outlive this. `round` makes the names unique.
  Traffic(const std::string& server, const SampleViews& samples, int round, Ledger& ledger);
  // Waits for the calls, which end with the server.
  ~Traffic();

  // To be called before the server is killed: errors are expected from now on.
  void ExpectEnd() { ending_ = true; }
  bool commits() const { return committing_; }
  bool backs_up() const { return backing_up_; }

 private:
  void Upload(int thread);
  void Delete();
  void UploadInBulk();
  absl::Status StageViews(const std::string& upload, int stream);
  absl::Status CommitBulk(const std::string& upload);
  void BackUp();
  // Whether to go on after a call.
  bool GoesOn(const absl::Status& status, const char* call) const;
  client::Client Connect() const;

  const std::string server_;
  const SampleViews& samples_;
  const int round_;
  Ledger& ledger_;
  std::atomic<bool> ending_ = false;
  std::atomic<bool> committing_ = false;
  std::atomic<bool> backing_up_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace graspdb::faults
