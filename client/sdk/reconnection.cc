#include "client/sdk/reconnection.h"

#include <chrono>
#include <utility>

namespace graspdb::client {
namespace {

// Between two looks whether the client is destroyed. Doubled, that takes up to 0.2 s.
constexpr std::chrono::milliseconds kLook(100);

}  // namespace

Reconnection::Reconnection(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}

Reconnection::~Reconnection() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void Reconnection::Begin() {
  if (channel_->GetState(/*try_to_connect=*/false) == GRPC_CHANNEL_READY) return;
  const std::scoped_lock lock(mutex_);
  if (waiting_) return;
  if (thread_.joinable()) thread_.join();
  waiting_ = true;
  thread_ = std::thread([this] { Wait(); });
}

void Reconnection::Wait() {
  while (!stopping_) {
    const grpc_connectivity_state state = channel_->GetState(/*try_to_connect=*/true);
    if (state == GRPC_CHANNEL_READY) break;
    channel_->WaitForStateChange(state, std::chrono::system_clock::now() + kLook);
  }
  const std::scoped_lock lock(mutex_);
  waiting_ = false;
}

}  // namespace graspdb::client
