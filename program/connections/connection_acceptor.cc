#include "program/connections/connection_acceptor.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "base/status_macros.h"
#include "program/connections/descriptor_limit.h"
#include "program/connections/peer_address.h"
#include "program/log/log_field.h"

namespace graspdb {
namespace {

// Share of the descriptors that files keep: one in so many.
constexpr int kFileShare = 4;

// Connections at most, whatever the limit of descriptors: each takes some 20 KB in gRPC.
constexpr int kMaxConnections = 16'384;

// Pause while the system has no descriptor or memory.
constexpr std::chrono::milliseconds kShortagePause{20};

// Connections of one socket that are accepted before the others are looked at.
constexpr int kAcceptedAtOnce = 64;

constexpr std::chrono::milliseconds kWatchInterval{200};

constexpr std::string_view kLimitAdvice =
    "close connections that are not needed, or raise the limit of open files (ulimit -n, "
    "LimitNOFILE)";

bool IsShortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

FileDescriptor OpenSpare() { return FileDescriptor(open("/dev/null", O_RDONLY | O_CLOEXEC)); }

FileDescriptor AcceptFrom(int listener) {
  return FileDescriptor(accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

}  // namespace

absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> ConnectionAcceptor::Listen(
    const ListenAddress& address) {
  ASSIGN_OR_RETURN(ListeningSockets listening, ListenAt(address));
  FileDescriptor stop(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!stop.is_open()) return absl::UnavailableError(std::generic_category().message(errno));
  return std::unique_ptr<ConnectionAcceptor>(
      new ConnectionAcceptor(std::move(listening), std::move(stop)));
}

// The system takes the lowest free number for a descriptor, so that the number of a new connection
// is at most that of the descriptors in use.
ConnectionAcceptor::ConnectionAcceptor(ListeningSockets listening, FileDescriptor stop)
    : listening_(std::move(listening)),
      stop_(std::move(stop)),
      spare_(OpenSpare()),
      descriptor_limit_(DescriptorLimit()),
      max_connection_(std::min(descriptor_limit_ - descriptor_limit_ / kFileShare,
                               stop_.number() + kMaxConnections)),
      shares_(max_connection_ + 1) {}

ConnectionAcceptor::~ConnectionAcceptor() { Stop(); }

void ConnectionAcceptor::AddTo(grpc::ServerBuilder& builder,
                               std::shared_ptr<grpc::ServerCredentials> credentials) {
  using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  server_ =
      builder.experimental().AddExternalConnectionAcceptor(Type::FROM_FD, std::move(credentials));
}

void ConnectionAcceptor::Start(ConnectionWatch* watch) {
  watch_ = watch;
  thread_ = std::thread([this] { Run(); });
}

void ConnectionAcceptor::Stop() {
  if (thread_.joinable()) {
    eventfd_write(stop_.number(), 1);
    thread_.join();
  }
  listening_.sockets.clear();
}

void ConnectionAcceptor::Run() {
  while (AwaitConnections()) {
    for (const FileDescriptor& socket : listening_.sockets) AcceptAll(socket.number());
    if (watch_ != nullptr) watch_->Check();
  }
}

bool ConnectionAcceptor::AwaitConnections() {
  std::vector<pollfd> events = {{stop_.number(), POLLIN, 0}};
  for (const FileDescriptor& socket : listening_.sockets) {
    events.push_back({socket.number(), POLLIN, 0});
  }
  const int timeout_ms = watch_ == nullptr ? -1 : static_cast<int>(kWatchInterval.count());
  while (poll(events.data(), events.size(), timeout_ms) < 0) {
    // Without memory for it the system may refuse to wait.
    if (errno != EINTR) std::this_thread::sleep_for(kShortagePause);
  }
  return events.front().revents == 0;
}

void ConnectionAcceptor::AcceptAll(int listener) {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    FileDescriptor connection = AcceptFrom(listener);
    if (connection.is_open()) {
      Pass(listener, std::move(connection));
      continue;
    }
    const int error = errno;
    if (error == EINTR || error == ECONNABORTED) continue;  // it is gone already
    if (IsShortage(error)) RefuseWithoutDescriptor(listener, error);
    return;
  }
}

void ConnectionAcceptor::Pass(int listener, FileDescriptor connection) {
  if (connection.number() > max_connection_) {
    NoteRefusal("too many connections for the limit of open files", kLimitAdvice);
    return;
  }
  if (!shares_.Add(connection.number())) {
    NoteRefusal("too many connections from one address", kLimitAdvice);
    return;
  }
  if (watch_ != nullptr && !watch_->Add(connection.number(), PeerOf(connection.number()))) {
    NoteRefusal("a connection of its address was ended", "wait some seconds");
    return;
  }
  const int on = 1;  // as gRPC does: a call's last small packet need not wait for the one before it
  setsockopt(connection.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
  parameters.listener_fd = listener;
  parameters.fd = connection.Release();
  server_->HandleNewConnection(&parameters);
}

void ConnectionAcceptor::RefuseWithoutDescriptor(int listener, int error) {
  NoteRefusal(std::generic_category().message(error), kLimitAdvice);
  spare_.Close();
  AcceptFrom(listener).Close();
  spare_ = OpenSpare();
  pollfd stop = {stop_.number(), POLLIN, 0};
  poll(&stop, 1, static_cast<int>(kShortagePause.count()));
}

void ConnectionAcceptor::NoteRefusal(std::string_view reason, std::string_view advice) {
  ++refused_;
  const std::optional<std::int64_t> count = refusals_.Count();
  if (!count) return;
  spdlog::warn("event=connections_refused count={} open_files_limit={} reason={} advice={}", *count,
               descriptor_limit_, LogField(reason), LogField(advice));
}

}  // namespace graspdb
