// Connections by the address that they come from.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "program/connections/descriptor_limit.h"

namespace graspdb {

// Limits the connections of one address to half of those that there may be, so that one machine
// does not shut out the others. Whoever closes a connection need not report it: its descriptor's
// number shows that it is gone. For one thread.
class ConnectionShares {
 public:
  // `max_descriptors`: of files and connections together. `count_descriptors`: that are open.
  explicit ConnectionShares(int max_descriptors,
                            std::function<int()> count_descriptors = CountDescriptors);

  // Counts a new connection, whose descriptor this is; false if its address has too many.
  bool Add(int connection);

 private:
  // Leaves out the connections that were closed, and counts the files, unless it has been done
  // within `pause`.
  void RecountIfOlderThan(std::chrono::milliseconds pause);
  int MaxOfAddress() const;
  // A connection of this client was closed; empty: there was none.
  void Forget(const std::string& peer);

  const int max_descriptors_;
  const std::function<int()> count_descriptors_;
  int files_ = 0;                                // and whatever else is no connection
  std::vector<std::string> peers_;               // by descriptor; empty: none
  std::unordered_map<std::string, int> counts_;  // by address, or IPv6 network
  std::optional<std::chrono::steady_clock::time_point> last_recount_;
};

}  // namespace graspdb
