#include "client/cell/robots/robot_connection.h"

#include <spdlog/spdlog.h>

#include <asio/buffer.hpp>
#include <asio/post.hpp>
#include <asio/write.hpp>
#include <exception>
#include <utility>

#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

std::string AddressOf(const asio::ip::tcp::socket& socket) {
  asio::error_code gone;
  const auto endpoint = socket.remote_endpoint(gone);
  return gone ? "unknown" : endpoint.address().to_string();
}

// An exception of a library must not end the agent, and with it the jobs of all robots.
RobotReply AnswerGuarded(RobotProtocol& protocol, const std::string& robot,
                         const std::string& message) {
  try {
    return protocol.Answer(robot, message);
  } catch (const std::exception& e) {
    spdlog::error("event=robot_not_answered robot={} error={}", robot, LogField(e.what()));
    return {.bytes = {}, .hang_up = true};
  }
}

}  // namespace

RobotConnection::RobotConnection(asio::ip::tcp::socket socket, asio::thread_pool& workers,
                                 RobotProtocol& protocol, std::chrono::milliseconds message_time)
    : socket_(std::move(socket)),
      workers_(workers),
      protocol_(protocol),
      message_time_(message_time),
      robot_(AddressOf(socket_)),
      deadline_(socket_.get_executor()) {
  // No delay, because robots wait for small answers; keep-alive detects a robot whose cable was
  // unplugged. If setting these fails, both only take longer.
  asio::error_code refused;
  socket_.set_option(asio::ip::tcp::no_delay(true), refused);
  socket_.set_option(asio::socket_base::keep_alive(true), refused);
  spdlog::info("event=robot_connected robot={}", robot_);
}

RobotConnection::~RobotConnection() { spdlog::info("event=robot_gone robot={}", robot_); }

void RobotConnection::HangUp() {
  asio::error_code closed_already;
  deadline_.cancel();
  socket_.close(closed_already);
}

void RobotConnection::Continue() {
  if (!socket_.is_open()) return;
  const std::size_t bytes = protocol_.MessageBytes(received_);
  if (bytes > 0) return Answer(bytes);
  if (!received_.empty() && !in_message_) BeginDeadline();
  Receive();
}

void RobotConnection::BeginDeadline() {
  in_message_ = true;
  deadline_.expires_after(message_time_);
  deadline_.async_wait([self = shared_from_this()](asio::error_code cancelled) {
    // It may have expired just before it was cancelled.
    if (cancelled || !self->in_message_) return;
    if (self->deadline_.expiry() > asio::steady_timer::clock_type::now()) return;
    spdlog::warn("event=robot_too_slow robot={} unfinished_bytes={}", self->robot_,
                 self->received_.size());
    self->HangUp();
  });
}

void RobotConnection::Receive() {
  socket_.async_read_some(asio::buffer(next_),
                          [self = shared_from_this()](asio::error_code error, std::size_t bytes) {
                            if (error) return self->HangUp();
                            self->received_.append(self->next_.data(), bytes);
                            self->Continue();
                          });
}

void RobotConnection::Answer(std::size_t bytes) {
  in_message_ = false;
  deadline_.cancel();
  std::string message = received_.substr(0, bytes);
  received_.erase(0, bytes);
  asio::post(workers_, [self = shared_from_this(), message = std::move(message)]() mutable {
    RobotReply reply = AnswerGuarded(self->protocol_, self->robot_, message);
    const auto executor = self->socket_.get_executor();
    // The worker releases its reference; otherwise the connection could end on its thread.
    asio::post(executor, [self = std::move(self), reply = std::move(reply)]() mutable {
      self->Send(std::move(reply));
    });
  });
}

void RobotConnection::Send(RobotReply reply) {
  if (!socket_.is_open()) return;
  const auto sent = std::make_shared<const RobotReply>(std::move(reply));
  asio::async_write(socket_, asio::buffer(sent->bytes),
                    [self = shared_from_this(), sent](asio::error_code error, std::size_t) {
                      if (error) return self->HangUp();
                      if (sent->hang_up) return self->DrainAndClose();
                      self->Continue();
                    });
}

void RobotConnection::DrainAndClose() {
  if (!socket_.is_open()) return;
  if (!in_message_) {
    BeginDeadline();
    asio::error_code gone_already;
    socket_.shutdown(asio::ip::tcp::socket::shutdown_send, gone_already);
  }
  socket_.async_read_some(asio::buffer(next_),
                          [self = shared_from_this()](asio::error_code error, std::size_t) {
                            if (error) return self->HangUp();
                            self->DrainAndClose();
                          });
}

}  // namespace graspdb::client
