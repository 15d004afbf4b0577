#include "console/gateway.h"

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "console/http_connection.h"
#include "program/connections/listen_address.h"
#include "program/connections/listening_sockets.h"
#include "program/connections/loopback.h"
#include "program/log/log_field.h"
#include "program/tls/pem_files.h"
#include "program/tls/watched_files.h"

namespace graspdb::console {
namespace {

namespace net = boost::asio;
using net::ip::tcp;
using ErrorCode = boost::system::error_code;

// One converts a large message while the others go on.
constexpr int kHttpThreads = 3;
constexpr std::chrono::milliseconds kAcceptPause(100);  // without a free descriptor

// TLS 1.2 or later. FAILED_PRECONDITION for files that do not fit.
absl::StatusOr<std::shared_ptr<net::ssl::context>> MakeTls(const GatewayOptions& options) {
  absl::Status usable =
      CheckKeyPair({"--tls-cert", options.tls_cert}, {"--tls-key", options.tls_key});
  if (!usable.ok()) return usable;
  auto tls = std::make_shared<net::ssl::context>(net::ssl::context::tls_server);
  ErrorCode error;
  tls->set_options(net::ssl::context::default_workarounds | net::ssl::context::no_sslv2 |
                       net::ssl::context::no_sslv3 | net::ssl::context::no_tlsv1 |
                       net::ssl::context::no_tlsv1_1,
                   error);
  if (!error) tls->use_certificate_chain_file(options.tls_cert, error);
  if (!error) tls->use_private_key_file(options.tls_key, net::ssl::context::pem, error);
  if (!error) return tls;
  return absl::FailedPreconditionError(
      absl::StrCat("--tls-cert and --tls-key cannot be used: ", error.message()));
}

tcp FamilyOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4();
}

}  // namespace

struct Gateway::Parts {
  Parts(Origins origins, std::span<const PageFile> files, std::unique_ptr<Upstream> server,
        const HttpLimits& limits)
      : upstream(std::move(server)),
        site{.origins = std::move(origins),
             .files = files,
             .upstream = *upstream,
             .limits = limits} {}

  void Listen(ListeningSockets sockets);
  // Uses the files of TLS, and those that replace them for new connections.
  absl::Status UseTls(const GatewayOptions& options);
  bool RenewTls(const GatewayOptions& options);
  void Accept(std::size_t listener);
  void Take(tcp::socket socket);

  net::io_context context;
  std::mutex tls_mutex;
  std::shared_ptr<net::ssl::context> tls;  // null: none
  std::unique_ptr<Upstream> upstream;
  Site site;
  std::vector<tcp::acceptor> acceptors;
  std::vector<net::steady_timer> pauses;  // of each acceptor
  std::string url;
  std::uint16_t port = 0;
  std::vector<std::thread> threads;
  bool is_tls_invalid = false;              // of the next one's thread: was logged
  std::unique_ptr<WatchedFiles> tls_files;  // whose thread renews `tls`
};

absl::Status Gateway::Parts::UseTls(const GatewayOptions& options) {
  if (options.tls_cert.empty()) return absl::OkStatus();
  // Before the files are read, so that no change is missed between.
  tls_files =
      std::make_unique<WatchedFiles>(std::vector<std::string>{options.tls_cert, options.tls_key});
  absl::StatusOr<std::shared_ptr<net::ssl::context>> made = MakeTls(options);
  if (!made.ok()) return made.status();
  tls = *std::move(made);
  tls_files->Start([this, options] { return RenewTls(options); });
  return absl::OkStatus();
}

bool Gateway::Parts::RenewTls(const GatewayOptions& options) {
  absl::StatusOr<std::shared_ptr<net::ssl::context>> made = MakeTls(options);
  if (!made.ok()) {  // e.g. half written: those from before stay in use
    if (!std::exchange(is_tls_invalid, true)) {
      spdlog::warn("event=tls_files_invalid error={}",
                   LogField(std::string(made.status().message())));
    }
    return false;
  }
  is_tls_invalid = false;
  const std::scoped_lock lock(tls_mutex);
  tls = *std::move(made);
  return true;
}

void Gateway::Parts::Listen(ListeningSockets sockets) {
  port = sockets.port;
  for (FileDescriptor& socket : sockets.sockets) {
    const tcp family = FamilyOf(socket.number());
    acceptors.emplace_back(context, family, socket.Release());
    pauses.emplace_back(context);
  }
  for (std::size_t i = 0; i < acceptors.size(); ++i) Accept(i);
}

void Gateway::Parts::Accept(std::size_t listener) {
  acceptors[listener].async_accept(
      net::make_strand(context), [this, listener](ErrorCode error, tcp::socket socket) {
        if (error == net::error::operation_aborted) return;
        if (!error) {
          Take(std::move(socket));
          return Accept(listener);
        }
        pauses[listener].expires_after(kAcceptPause);
        pauses[listener].async_wait([this, listener](ErrorCode stopped) {
          if (!stopped) Accept(listener);
        });
      });
}

void Gateway::Parts::Take(tcp::socket socket) {
  if (site.connection_count >= site.limits.max_connections) return;  // closed by its destructor
  ErrorCode ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  const auto executor = socket.get_executor();
  std::shared_ptr<net::ssl::context> current;
  {
    const std::scoped_lock lock(tls_mutex);
    current = tls;
  }
  if (current != nullptr) {
    using TlsStream = net::ssl::stream<tcp::socket>;  // which keeps what it needs of the context
    auto connection =
        std::make_shared<HttpConnection<TlsStream>>(TlsStream(std::move(socket), *current), site);
    net::post(executor, [connection] { connection->Start(); });
  } else {
    auto connection = std::make_shared<HttpConnection<tcp::socket>>(std::move(socket), site);
    net::post(executor, [connection] { connection->Start(); });
  }
}

absl::Status CheckOptions(const GatewayOptions& options) {
  const absl::StatusOr<ListenAddress> listen = ParseListenAddress("--listen", options.listen);
  if (!listen.ok()) return listen.status();
  if (options.tls_cert.empty() != options.tls_key.empty()) {
    return absl::InvalidArgumentError("--tls-cert and --tls-key belong together; give both");
  }
  if (!options.tls_cert.empty()) {
    return CheckKeyPair({"--tls-cert", options.tls_cert}, {"--tls-key", options.tls_key});
  }
  if (IsLoopback(listen->host) || options.behind_proxy) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "--listen ", options.listen,
      " can be reached from other machines without encryption; give --tls-cert and --tls-key, "
      "listen on 127.0.0.1, or add --behind-proxy if only a proxy with TLS reaches it"));
}

absl::StatusOr<std::unique_ptr<Gateway>> Gateway::Start(const GatewayOptions& options,
                                                        std::span<const PageFile> files,
                                                        std::unique_ptr<Upstream> upstream) {
  if (absl::Status usable = CheckOptions(options); !usable.ok()) return usable;
  const absl::StatusOr<ListenAddress> address = ParseListenAddress("--listen", options.listen);
  absl::StatusOr<ListeningSockets> sockets = ListenAt(*address);
  if (!sockets.ok()) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", options.listen, " (",
                                               sockets.status().message(),
                                               "); give another --listen"));
  }
  const bool has_tls = !options.tls_cert.empty();
  try {
    auto parts = std::make_unique<Parts>(
        Origins(address->host, sockets->port, options.hosts, has_tls || options.behind_proxy),
        files, std::move(upstream), options.limits);
    if (absl::Status used = parts->UseTls(options); !used.ok()) return used;
    parts->url =
        absl::StrCat(has_tls ? "https://" : "http://", address->host, ":", sockets->port, "/");
    parts->Listen(*std::move(sockets));
    for (int i = 0; i < kHttpThreads; ++i) {
      parts->threads.emplace_back([&context = parts->context] { context.run(); });
    }
    return std::unique_ptr<Gateway>(new Gateway(std::move(parts)));
  } catch (const std::exception& e) {  // of Asio
    return absl::UnavailableError(
        absl::StrCat("cannot listen on ", options.listen, ": ", e.what()));
  }
}

Gateway::Gateway(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Gateway::~Gateway() {
  parts_->context.stop();
  for (std::thread& thread : parts_->threads) thread.join();
  // Its calls keep connections, which use the context.
  parts_->upstream.reset();
}

const std::string& Gateway::url() const { return parts_->url; }
std::uint16_t Gateway::port() const { return parts_->port; }
int Gateway::connection_count() const { return parts_->site.connection_count; }

}  // namespace graspdb::console
