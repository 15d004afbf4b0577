#include "client/cell/robots/robot_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>
#include <asio/thread_pool.hpp>
#include <future>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/robots/robot_connection.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

// Pause after a failed accept, e.g. when all file handles are in use.
constexpr std::chrono::milliseconds kAcceptRetryPause{100};

}  // namespace

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
