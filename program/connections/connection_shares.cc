#include "program/connections/connection_shares.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "program/connections/peer_address.h"

namespace graspdb {
namespace {

// Of the connections one address gets one in so many.
constexpr int kAddressShare = 2;

// A recount looks at all connections.
constexpr std::chrono::milliseconds kRecountPause{100};

// The same for files, whose number changes slowly.
constexpr std::chrono::milliseconds kFileRecountPause{1000};

}  // namespace

ConnectionShares::ConnectionShares(int max_descriptors, std::function<int()> count_descriptors)
    : max_descriptors_(max_descriptors), count_descriptors_(std::move(count_descriptors)) {}

int ConnectionShares::MaxOfAddress() const {
  return std::max(1, (max_descriptors_ - files_) / kAddressShare);
}

bool ConnectionShares::Add(int connection) {
  const auto slot = static_cast<std::size_t>(connection);
  if (slot >= peers_.size()) peers_.resize(slot + 1);
  Forget(peers_[slot]);  // that connection was closed, since its number was free
  peers_[slot] = PeerOf(connection);
  if (peers_[slot].empty()) return true;
  const std::string address = NetworkOfPeer(peers_[slot]);
  ++counts_[address];
  RecountIfOlderThan(kFileRecountPause);
  if (counts_[address] > MaxOfAddress()) RecountIfOlderThan(kRecountPause);
  if (counts_[address] <= MaxOfAddress()) return true;
  Forget(peers_[slot]);
  peers_[slot].clear();
  return false;
}

void ConnectionShares::RecountIfOlderThan(std::chrono::milliseconds pause) {
  const auto now = std::chrono::steady_clock::now();
  if (last_recount_ && now - *last_recount_ < pause) return;
  last_recount_ = now;
  files_ = count_descriptors_();
  counts_.clear();
  for (std::size_t slot = 0; slot < peers_.size(); ++slot) {
    std::string& peer = peers_[slot];
    if (peer.empty()) continue;
    if (PeerOf(static_cast<int>(slot)) == peer) {
      ++counts_[NetworkOfPeer(peer)];
      --files_;
    } else {
      peer.clear();
    }
  }
  files_ = std::max(files_, 0);  // connections end meanwhile
}

void ConnectionShares::Forget(const std::string& peer) {
  if (peer.empty()) return;
  const auto found = counts_.find(NetworkOfPeer(peer));
  if (found != counts_.end() && --found->second == 0) counts_.erase(found);
}

}  // namespace graspdb
