#include "program/tls/tls_file_set.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "tests/files/temporary_folder.h"
#include "tests/testing/certificates.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kUnusable = absl::StatusCode::kFailedPrecondition;

class TlsFileSetTest : public ::testing::Test {
 protected:
  TlsFileSetTest() { Write(authority_.IssueForLoopback()); }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  void Write(const testing::KeyPair& pair) const {
    folder_.Write("pem", pair.certificate);
    folder_.Write("key", pair.key);
  }

  void Serve() {
    grpc::experimental::TlsServerCredentialsOptions options(set_.MakeProvider());
    options.watch_identity_key_cert_pairs();
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::experimental::TlsServerCredentials(options),
                             &port_);
    builder.RegisterCallbackGenericService(&service_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
  }
  // Whether a new connection that trusts the authority succeeds within some seconds.
  bool IsServedTo(const testing::Authority& authority) const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 100);
    grpc::SslCredentialsOptions trusting;
    trusting.pem_root_certs = authority.certificate();
    return grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port_),
                                     grpc::SslCredentials(trusting), arguments)
        ->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(20));
  }

  const files::TemporaryFolder folder_;
  const testing::Authority authority_{"plant"};
  TlsFileSet& set_ = TlsFileSet::Of(
      {.certificate = {"--tls-cert", Path("pem")}, .key = {"--tls-key", Path("key")}});
  grpc::CallbackGenericService service_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(TlsFileSetTest, ThereIsOneForTheSameFiles) {
  EXPECT_EQ(&TlsFileSet::Of(
                {.certificate = {"--tls-cert", Path("pem")}, .key = {"--tls-key", Path("key")}}),
            &set_);
  EXPECT_NE(&TlsFileSet::Of({.authorities = {"--ca", Path("pem")}}), &set_);
}

TEST_F(TlsFileSetTest, FilesThatCannotBeUsedLeaveThoseOfBeforeInUse) {
  ASSERT_THAT(set_.Refresh(), IsOk());
  Serve();
  EXPECT_TRUE(IsServedTo(authority_));
  std::filesystem::resize_file(Path("pem"), 0);
  EXPECT_THAT(set_.Refresh(), StatusIs(kUnusable, HasSubstr("--tls-cert")));
  std::filesystem::resize_file(Path("key"), 0);
  std::this_thread::sleep_for(std::chrono::seconds(2));  // gRPC reads each second
  EXPECT_TRUE(IsServedTo(authority_));
  Write({authority_.IssueForLoopback().certificate, authority_.IssueForLoopback().key});
  EXPECT_THAT(set_.Refresh(), StatusIs(kUnusable, HasSubstr("is not the key of --tls-cert")));
  EXPECT_TRUE(IsServedTo(authority_));
  const testing::Authority next("next");
  Write(next.IssueForLoopback());
  EXPECT_THAT(set_.Refresh(), IsOk());
  EXPECT_TRUE(IsServedTo(next));
}

TEST_F(TlsFileSetTest, FilesThatAppearLaterAreUsed) {
  std::filesystem::remove(Path("key"));
  EXPECT_THAT(set_.Refresh(), StatusIs(kUnusable, HasSubstr("cannot be read")));
  Serve();
  Write(authority_.IssueForLoopback());
  EXPECT_THAT(set_.Refresh(), IsOk());
  EXPECT_TRUE(IsServedTo(authority_));
}

}  // namespace
}  // namespace graspdb
