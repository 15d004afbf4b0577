// Compares a server with what was acknowledged.
#pragma once

#include <random>
#include <string>

#include "tests/faults/ledger.h"
#include "tests/faults/sample_views.h"

namespace graspdb::faults {

struct CheckCounts {
  int lost = 0;        // acknowledged and not there, or with other bytes
  int unanswered = 0;  // writes that were not answered
  int applied = 0;     // of these, those that the server had applied
  int uploads = 0;     // bulk uploads that were interrupted
};

// Checks the server, fails the test for each difference, and sets the pending views of the ledger
// to what the server has. Completes or deletes interrupted bulk uploads. `everything`: reads the
// clouds of all views, instead of those since the last check.
class LedgerCheck {
 public:
  // All must outlive this.
  LedgerCheck(client::Client& client, const SampleViews& samples, Ledger& ledger,
              CheckCounts& counts)
      : client_(client), samples_(samples), ledger_(ledger), counts_(counts) {}

  void Run(std::mt19937_64& random, bool everything);

 private:
  void CheckViews(bool everything);
  void CheckView(const std::string& name, KnownView& known);
  void CheckUploads(std::mt19937_64& random);
  void CheckOpenUpload(const std::string& name, const KnownUpload& known, bool completes);
  void AddPublished(const KnownUpload& known);
  void CheckNames();
  void CheckIndex(std::mt19937_64& random);
  void CheckBackups();
  // Counts a lost write and fails the test.
  void Lost(const std::string& what);

  client::Client& client_;
  const SampleViews& samples_;
  Ledger& ledger_;
  CheckCounts& counts_;
};

}  // namespace graspdb::faults
