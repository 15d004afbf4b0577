#include "client/cell/agent/health.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>

#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "program/stop_flag.h"

namespace graspdb::client {
namespace {

constexpr char kService[] = "graspdb.cell";

}  // namespace

class Health::Watch {
 public:
  Watch(std::unique_ptr<grpc::Server> server, std::string address, std::function<bool()> is_ready,
        absl::Duration period)
      : server_(std::move(server)),
        address_(std::move(address)),
        is_ready_(std::move(is_ready)),
        period_(period),
        thread_([this] { Run(); }) {}

  ~Watch() {
    stop_.Raise();
    thread_.join();
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

  const std::unique_ptr<grpc::Server> server_;
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
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(listen, grpc::InsecureServerCredentials(), &port);
  // Otherwise two cells could share the port and answer each other's checks.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (server == nullptr || port == 0) {
    return absl::UnavailableError(
        absl::StrCat("cannot listen on ", listen,
                     " for the health service; is the port in use? Choose another --health"));
  }
  const std::string address = absl::StrCat(listen.substr(0, listen.rfind(':')), ":", port);
  return std::unique_ptr<Health>(
      new Health(std::make_unique<Watch>(std::move(server), address, std::move(is_ready), period)));
}

}  // namespace graspdb::client
