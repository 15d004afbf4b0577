#include "client/sdk/reconnection.h"

#include <chrono>
#include <system_error>
#include <utility>

namespace graspdb::client {
namespace {

// Between two checks whether the client is destroyed.
constexpr std::chrono::milliseconds kCheck(100);

}  // namespace

Reconnection::Reconnection(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}

Reconnection::~Reconnection() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

bool Reconnection::IsConnected() const {
  return channel_->GetState(/*try_to_connect=*/false) == GRPC_CHANNEL_READY;
}

void Reconnection::Begin() {
  const std::scoped_lock lock(mutex_);
  if (waiting_) return;
  if (thread_.joinable()) thread_.join();
  try {
    thread_ = std::thread([this] { Wait(); });
    waiting_ = true;
  } catch (const std::system_error&) {
    // As described: the connection then takes longer, or the next failed call begins.
  }
}

void Reconnection::Wait() {
  while (!stopping_) {
    const grpc_connectivity_state state = channel_->GetState(/*try_to_connect=*/true);
    if (state == GRPC_CHANNEL_READY) break;
    channel_->WaitForStateChange(state, std::chrono::system_clock::now() + kCheck);
  }
  const std::scoped_lock lock(mutex_);
  waiting_ = false;
}

}  // namespace graspdb::client
