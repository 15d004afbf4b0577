#include "client/cell/agent/health.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>

#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/base/stop_flag.h"
#include "program/connections/connection_acceptor.h"
#include "program/connections/listen_address.h"

namespace graspdb::client {
namespace {

constexpr char kService[] = "graspdb.cell";

}  // namespace

class Health::Watch {
 public:
  Watch(std::unique_ptr<grpc::CallbackGenericService> others, std::unique_ptr<grpc::Server> server,
        std::unique_ptr<ConnectionAcceptor> acceptor, std::string address,
        std::function<bool()> is_ready, absl::Duration period)
      : others_(std::move(others)),
        server_(std::move(server)),
        acceptor_(std::move(acceptor)),
        address_(std::move(address)),
        is_ready_(std::move(is_ready)),
        period_(period),
        thread_([this] { Run(); }) {
    acceptor_->Start();
  }

  ~Watch() {
    stop_.Raise();
    thread_.join();
    acceptor_->Stop();
    server_->Shutdown(std::chrono::system_clock::now());
  }

  const std::string& address() const { return address_; }

 private:
  void Run() {
    do {
      const bool ready = is_ready_();
      server_->GetHealthCheckService()->SetServingStatus(ready);
      server_->GetHealthCheckService()->SetServingStatus(kService, ready);
    } while (!stop_.Wait(absl::ToChronoNanoseconds(period_)));
  }

  const std::unique_ptr<grpc::CallbackGenericService> others_;
  const std::unique_ptr<grpc::Server> server_;
  const std::unique_ptr<ConnectionAcceptor> acceptor_;
  const std::string address_;
  const std::function<bool()> is_ready_;
  const absl::Duration period_;
  StopFlag stop_;
  std::thread thread_;
};

Health::Health(std::unique_ptr<Watch> watch) : watch_(std::move(watch)) {}
Health::~Health() = default;

const std::string& Health::address() const { return watch_->address(); }

absl::StatusOr<std::unique_ptr<Health>> Health::Start(const std::string& listen,
                                                      std::function<bool()> is_ready,
                                                      absl::Duration period) {
  ASSIGN_OR_RETURN(const ListenAddress address, ParseListenAddress("--health", listen));
  absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> acceptor =
      ConnectionAcceptor::Listen(address);
  if (!acceptor.ok()) {
    return absl::UnavailableError(absl::StrCat(
        "cannot listen on ", listen, " for the health service (", acceptor.status().message(),
        "); is the port in use? Choose another --health"));
  }
  grpc::EnableDefaultHealthCheckService(true);
  grpc::ServerBuilder builder;
  (*acceptor)->AddTo(builder, grpc::InsecureServerCredentials());
  // For all other methods: without a service gRPC does not start.
  auto others = std::make_unique<grpc::CallbackGenericService>();
  builder.RegisterCallbackGenericService(others.get());
  std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (server == nullptr) return absl::InternalError("gRPC does not start the health service");
  const std::string at = absl::StrCat(address.host, ":", (*acceptor)->port());
  return std::unique_ptr<Health>(
      new Health(std::make_unique<Watch>(std::move(others), std::move(server), *std::move(acceptor),
                                         at, std::move(is_ready), period)));
}

}  // namespace graspdb::client
