#include "client/cell/robots/robot_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <asio/buffer.hpp>
#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>
#include <asio/thread_pool.hpp>
#include <asio/write.hpp>
#include <exception>
#include <future>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {

// Reads messages, passes them to a worker, and writes its answers. Lives as long as an operation is
// pending. All handlers run on the one thread of the socket's context.
class RobotConnection : public std::enable_shared_from_this<RobotConnection> {
 public:
  // `workers` and `protocol` must outlive it.
  RobotConnection(asio::ip::tcp::socket socket, asio::thread_pool& workers, RobotProtocol& protocol,
                  std::chrono::milliseconds message_time);
  ~RobotConnection();

  // Its address.
  const std::string& robot() const { return robot_; }

  // Begins, and continues after each answer.
  void Continue();
  // Cancels pending operations; answers still being computed are not sent.
  void HangUp();

 private:
  void Receive();
  void Answer(std::size_t bytes);
  void Send(RobotReply reply);
  // Closes the connection once the robot has closed its end: closing with unread bytes would make
  // the system discard the answer.
  void DrainAndClose();
  void BeginDeadline();

  asio::ip::tcp::socket socket_;
  asio::thread_pool& workers_;
  RobotProtocol& protocol_;
  const std::chrono::milliseconds message_time_;
  const std::string robot_;
  asio::steady_timer deadline_;
  bool in_message_ = false;  // while the deadline runs
  std::string received_;
  std::array<char, 1024> next_ = {};
};

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

// Pause after a failed accept, e.g. when all file handles are in use.
constexpr std::chrono::milliseconds kAcceptRetryPause{100};

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

absl::StatusOr<AllowList> AllowList::Parse(const std::vector<std::string>& networks) {
  AllowList out;
  for (const std::string& text : networks) {
    const bool is_v6 = text.find(':') != std::string::npos;
    const bool is_one = text.find('/') == std::string::npos;
    const std::string network = is_one ? text + (is_v6 ? "/128" : "/32") : text;
    asio::error_code error;
    if (is_v6) {
      out.v6_.push_back(asio::ip::make_network_v6(network, error).canonical());
    } else {
      out.v4_.push_back(asio::ip::make_network_v4(network, error).canonical());
    }
    if (error) {
      return absl::InvalidArgumentError(
          absl::StrCat("--robots-allow: ", text,
                       " is no network; give addresses or networks such as 10.3.0.0/24"));
    }
  }
  return out;
}

bool AllowList::Allows(const asio::ip::address& address) const {
  if (v4_.empty() && v6_.empty()) return true;
  if (address.is_v6() && !address.to_v6().is_v4_mapped()) {
    return std::ranges::any_of(v6_, [&](const asio::ip::network_v6& network) {
      return asio::ip::network_v6(address.to_v6(), network.prefix_length()).canonical() == network;
    });
  }
  const asio::ip::address_v4 v4 =
      address.is_v4() ? address.to_v4()
                      : asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
  return std::ranges::any_of(v4_, [&](const asio::ip::network_v4& network) {
    return asio::ip::network_v4(v4, network.prefix_length()).canonical() == network;
  });
}

class RobotServer::Listener {
 public:
  Listener(RobotProtocol& protocol, const RobotServerOptions& options)
      : protocol_(protocol), options_(options), workers_(options.workers) {}

  ~Listener() {
    if (!thread_.joinable()) return;
    std::promise<void> hung_up;
    asio::post(context_, [&] {
      HangUp();
      hung_up.set_value();
    });
    hung_up.get_future().wait();
    workers_.join();  // no more work is posted
    work_.reset();
    thread_.join();
  }

  absl::Status Listen() {
    ASSIGN_OR_RETURN(allow_, AllowList::Parse(options_.allow));
    asio::error_code error;
    const auto address = asio::ip::make_address(options_.address, error);
    if (error) return absl::InvalidArgumentError(options_.address + " is no IP address");
    const asio::ip::tcp::endpoint endpoint(address, options_.port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    if (error) {
      return absl::UnavailableError(absl::StrCat("cannot listen for robots on ", options_.address,
                                                 ":", options_.port, " (", error.message(),
                                                 "); is the port in use?"));
    }
    Accept();
    thread_ = std::thread([this] { context_.run(); });
    return absl::OkStatus();
  }

  std::uint16_t port() const { return port_; }

  std::size_t connection_count() {
    std::promise<std::size_t> count;
    asio::post(context_, [&] {
      std::erase_if(connections_, [](const auto& other) { return other.expired(); });
      count.set_value(connections_.size());
    });
    return count.get_future().get();
  }

 private:
  void HangUp() {
    stopping_ = true;
    asio::error_code closed_already;
    acceptor_.close(closed_already);
    retry_timer_.cancel();
    for (const auto& connection : connections_) {
      if (const auto open = connection.lock()) open->HangUp();
    }
  }

  void Accept() {
    acceptor_.async_accept([this](asio::error_code error, asio::ip::tcp::socket socket) {
      if (stopping_) return;
      if (error) return RetryAccept(error);
      AddConnection(std::move(socket));
      Accept();
    });
  }

  void RetryAccept(const asio::error_code& error) {
    spdlog::warn("event=robot_not_let_in error={}", LogField(error.message()));
    retry_timer_.expires_after(kAcceptRetryPause);
    retry_timer_.async_wait([this](asio::error_code /*cancelled*/) {
      if (!stopping_) Accept();
    });
  }

  void AddConnection(asio::ip::tcp::socket socket) {
    asio::error_code gone;
    const asio::ip::address robot = socket.remote_endpoint(gone).address();
    if (gone) return;
    if (!allow_.Allows(robot)) {
      spdlog::warn("event=robot_not_allowed robot={}", robot.to_string());
      return;
    }
    std::erase_if(connections_, [](const auto& other) { return other.expired(); });
    if (connections_.size() >= options_.max_connections ||
        ConnectionsOf(robot.to_string()) >= options_.max_connections_per_robot) {
      spdlog::warn("event=robot_turned_away robot={} connections={}", robot.to_string(),
                   connections_.size());
      return;
    }
    const auto connection = std::make_shared<RobotConnection>(std::move(socket), workers_,
                                                              protocol_, options_.message_time);
    connections_.push_back(connection);
    connection->Continue();
  }

  std::size_t ConnectionsOf(const std::string& robot) const {
    const auto is_of_robot = [&](const std::weak_ptr<RobotConnection>& other) {
      const auto open = other.lock();
      return open != nullptr && open->robot() == robot;
    };
    return static_cast<std::size_t>(std::ranges::count_if(connections_, is_of_robot));
  }

  RobotProtocol& protocol_;
  const RobotServerOptions options_;
  AllowList allow_;
  // All but the workers is used on the context's one thread only.
  asio::io_context context_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_ =
      asio::make_work_guard(context_);
  asio::thread_pool workers_;
  asio::ip::tcp::acceptor acceptor_{context_};
  asio::steady_timer retry_timer_{context_};
  std::vector<std::weak_ptr<RobotConnection>> connections_;
  bool stopping_ = false;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

RobotServer::RobotServer(std::unique_ptr<Listener> listener) : listener_(std::move(listener)) {}

RobotServer::~RobotServer() = default;

std::uint16_t RobotServer::port() const { return listener_->port(); }

std::size_t RobotServer::connection_count() const { return listener_->connection_count(); }

absl::StatusOr<std::unique_ptr<RobotServer>> RobotServer::Start(RobotProtocol& protocol,
                                                                const RobotServerOptions& options) {
  try {
    auto listener = std::make_unique<Listener>(protocol, options);
    RETURN_IF_ERROR(listener->Listen());
    return std::unique_ptr<RobotServer>(new RobotServer(std::move(listener)));
  } catch (const std::system_error& error) {  // threads or epoll
    return absl::ResourceExhaustedError(
        absl::StrCat("cannot serve robots (", error.what(), "); check the system's limits"));
  }
}

}  // namespace graspdb::client
