// Calls through the gateway.
#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <future>

#include "absl/strings/str_cat.h"
#include "console/connect_protocol.h"
#include "console/methods.h"
#include "graspdb/v1/change_service.pb.h"
#include "tests/console/gateway_fixture.h"

namespace graspdb::testing {
namespace {

using console::Envelope;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

class GatewayCallsTest : public ConsoleTest<ServerTest> {
 protected:
  void SetUp() override {
    options_.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options_.backup_dir);
    ServerTest::SetUp();
    StartGateway();
  }
};

TEST_F(GatewayCallsTest, EveryMethodCanBeCalled) {
  for (const std::string& path : console::MethodPaths()) {
    const google::protobuf::MethodDescriptor* method = console::FindMethod(path);
    // "x" is no UUID of a request: no backup is made.
    const std::string body = method->name() == "CreateBackup" ? R"({"requestId":"x"})" : "{}";
    const HttpResponse response =
        method->server_streaming() || method->client_streaming()
            ? Connect().Call(path, kJsonStream, Envelope(body), {{"Connect-Timeout-Ms", "500"}})
            : Connect().Call(path, kJson, body);
    EXPECT_THAT(response.status, ::testing::AnyOf(200, 400, 404)) << path << response.body;
    EXPECT_THAT(response.body, ::testing::Not(HasSubstr("unimplemented"))) << path;
  }
}

TEST_F(GatewayCallsTest, AWriteIsOneOfTheServer) {
  const HttpResponse made = Call("CatalogService/CreateObject", kJson,
                                 R"({"objectId":"box","object":{"displayName":"The \u00e4 box"}})");
  ASSERT_EQ(made.status, 200) << made.body;
  v1::GetObjectRequest request;
  request.set_name("objects/box");
  v1::Object object;
  ASSERT_THAT(ServerTest::Call(&Catalog::GetObject, request, &object), IsGrpcOk());
  EXPECT_EQ(object.display_name(), "The \u00e4 box");
  EXPECT_EQ(made.body, JsonOf(object));
  const HttpResponse gone = Call("CatalogService/DeleteObject", kJson, R"({"name":"objects/box"})");
  EXPECT_EQ(gone.status, 200);
  EXPECT_EQ(gone.body, "{}");
}

TEST_F(GatewayCallsTest, AnErrorHasItsCodeAndDetails) {
  const HttpResponse none = Call("CatalogService/GetObject", kJson, R"({"name":"objects/none"})");
  EXPECT_EQ(none.status, 404);
  EXPECT_EQ(none.Field("content-type"), kJson);
  EXPECT_THAT(none.body, HasSubstr(R"("code":"not_found")"));
  EXPECT_THAT(none.body, HasSubstr(R"("type":"google.rpc.ErrorInfo")"));
  EXPECT_THAT(none.Field("x-request-id"), SizeIs(16));
  const HttpResponse binary = Call("CatalogService/GetObject", kProto, "");
  EXPECT_EQ(binary.status, 400);
  EXPECT_EQ(binary.Field("content-type"), kJson) << "errors are JSON in the protocol";
  EXPECT_THAT(binary.body, HasSubstr("BadRequest"));
}

TEST_F(GatewayCallsTest, WrongRequestsDoNotReachTheServer) {
  const auto answer = [&](const std::string& type, const std::string& body,
                          const HttpFields& fields = {}) {
    const HttpResponse out = Call("CatalogService/ListObjects", type, body, fields);
    return absl::StrCat(out.status, " ", out.body);
  };
  EXPECT_THAT(answer(kJson, "{"), AllOf(StartsWith("400"), HasSubstr("in JSON")));
  EXPECT_THAT(answer(kJson, R"({"pageSise":1})"), AllOf(StartsWith("400"), HasSubstr("pageSise")));
  EXPECT_THAT(answer(kJson, std::string(100'000, '[')), StartsWith("400"));
  EXPECT_THAT(answer("text/plain", "{}"), AllOf(StartsWith("415"), HasSubstr(kJson)));
  EXPECT_THAT(answer(kJsonStream, Envelope("{}")), StartsWith("415"));
  EXPECT_THAT(answer(kJson, "{}", {{"Content-Encoding", "gzip"}}),
              AllOf(StartsWith("501"), HasSubstr("identity")));
  EXPECT_THAT(answer(kJson, "{}", {{"Connect-Protocol-Version", "2"}}), StartsWith("400"));
  EXPECT_THAT(answer(kJson, "{}", {{"Connect-Timeout-Ms", "soon"}}), StartsWith("400"));
  EXPECT_THAT(answer(kJson, "{}", {{"Authorization", "Bearer \xc3\xa4"}}), StartsWith("400"));
  EXPECT_THAT(answer(kJson, "{}", {{"Authorization", std::string(3000, 'x')}}), StartsWith("400"));
  EXPECT_THAT(answer(kProto, "\xff\xff", {{"x-request-id", "\"; x"}}),
              AllOf(StartsWith("500"), HasSubstr("internal")))
      << "the server's own error";
  EXPECT_EQ(Call("CatalogService/NoSuch", kJson, "{}").status, 404);
  EXPECT_EQ(Connect().Call("/grpc.health.v1.Health/Check", kJson, "{}").status, 404);
  EXPECT_EQ(Connect().Call("/graspdb.v1.CatalogService/../x", kJson, "{}").status, 404);
  EXPECT_EQ(Call("CatalogService/UploadViews", kProto, "").status, 415);
  EXPECT_THAT(Call("CatalogService/UploadViews", kProtoStream, Envelope("") + Envelope("")).body,
              HasSubstr("takes gRPC"));
}

TEST_F(GatewayCallsTest, ATimeLimitIsTheServers) {
  const HttpResponse late =
      Call("CatalogService/ListObjects", kJson, "{}", {{"Connect-Timeout-Ms", "0"}});
  EXPECT_EQ(late.status, 504);
  EXPECT_THAT(late.body, HasSubstr("deadline_exceeded"));
}

TEST_F(GatewayCallsTest, AStreamHasTheServersMessages) {
  const HttpResponse made = Call("BackupService/CreateBackup", kProtoStream, Envelope(""));
  ASSERT_EQ(made.status, 200);
  EXPECT_EQ(made.Field("content-type"), kProtoStream);
  const std::vector<StreamMessage> messages = MessagesOf(made.body);
  ASSERT_GE(messages.size(), 2U);
  EXPECT_EQ(messages.back().flags, 2);
  EXPECT_EQ(messages.back().bytes, "{}");
  v1::CreateBackupResponse last;
  ASSERT_TRUE(last.ParseFromString(messages[messages.size() - 2].bytes));
  v1::ListBackupsResponse backups;
  ASSERT_THAT(ServerTest::Call(&BackupStub::ListBackups, v1::ListBackupsRequest(), &backups),
              IsGrpcOk());
  ASSERT_THAT(backups.backups(), SizeIs(1));
  EXPECT_EQ(last.backup().SerializeAsString(), backups.backups(0).SerializeAsString());

  const HttpResponse verified =
      Call("BackupService/VerifyBackup", kJsonStream, Envelope(R"({"name":"backups/1"})"));
  const std::vector<StreamMessage> texts = MessagesOf(verified.body);
  ASSERT_GE(texts.size(), 2U);
  EXPECT_THAT(texts[texts.size() - 2].bytes, HasSubstr(R"("name":"backups/1")"));
}

TEST_F(GatewayCallsTest, AStreamEndsWithItsError) {
  const HttpResponse none =
      Call("BackupService/VerifyBackup", kJsonStream, Envelope(R"({"name":"backups/9"})"));
  EXPECT_EQ(none.status, 200) << "as the protocol has it";
  const std::vector<StreamMessage> messages = MessagesOf(none.body);
  ASSERT_FALSE(messages.empty());  // of a slow server after progress
  EXPECT_EQ(messages.back().flags, 2);
  EXPECT_THAT(messages.back().bytes,
              AllOf(HasSubstr(R"("code":"not_found")"), HasSubstr("ErrorInfo")));
  const HttpResponse wrong = Call("BackupService/VerifyBackup", kJsonStream, "{}");
  EXPECT_EQ(wrong.status, 200);
  EXPECT_THAT(MessagesOf(wrong.body)[0].bytes, HasSubstr("invalid_argument"));
}

TEST_F(GatewayCallsTest, ChangesComeAsTheyHappen) {
  const v1::CatalogStatus status = Status();
  HttpClient browser = Connect();
  const std::string body =
      Envelope(absl::StrCat(R"({"afterRevision":")", status.catalog_revision(),
                            R"(","catalogId":")", status.catalog_id(), R"("})"));
  browser.SendBytes(
      absl::StrCat("POST /graspdb.v1.ChangeService/WatchCatalog HTTP/1.1\r\nHost: "
                   "127.0.0.1:",
                   gateway_->port(), "\r\nContent-Type: ", kJsonStream,
                   "\r\nContent-Length: ", body.size(), "\r\n\r\n", body));
  ASSERT_THAT(CreateObject("box"), IsGrpcOk());
  std::string received;
  while (received.find("objects/box") == std::string::npos) {
    const std::string bytes = browser.ReceiveBytes();
    ASSERT_NE(bytes, "") << received;
    received += bytes;
  }
  EXPECT_THAT(received, StartsWith("HTTP/1.1 200"));
}

TEST_F(GatewayCallsTest, CancelledStreamsEnd) {
  for (int i = 0; i < 50; ++i) ASSERT_THAT(CreateObject(absl::StrCat("box-", i)), IsGrpcOk());
  v1::WatchCatalogRequest request;
  request.set_after_revision(0);
  for (int i = 0; i < 100; ++i) {
    std::promise<void> begun;
    std::atomic<bool> is_first = true;
    console::GrpcUpstream upstream({.server = server_->address()});
    const auto call = upstream.Start({.path = "/graspdb.v1.ChangeService/WatchCatalog",
                                      .is_stream = true,
                                      .message = request.SerializeAsString()},
                                     [&](const console::UpstreamEvent& /*event*/) {
                                       // A message, or the end where the server has too many
                                       // streams.
                                       if (is_first.exchange(false)) begun.set_value();
                                     });
    begun.get_future().wait();
    // While the next message arrives, which is not taken.
    call->Next();
    if (i % 2 == 0) call->Cancel();
    // The end of `upstream` waits for that of the call.
  }
}

TEST_F(GatewayCallsTest, OneConnectionTakesManyCalls) {
  HttpClient browser = Connect();
  for (int i = 0; i < 50; ++i) {
    const HttpResponse response =
        browser.Call("/graspdb.v1.CatalogService/ListObjects", i % 2 == 0 ? kJson : kProto, "");
    ASSERT_EQ(response.status, 200);
    EXPECT_EQ(response.Field("connection"), "keep-alive");
  }
  EXPECT_EQ(browser.Call("/graspdb.v1.CatalogService/GetObject", kJson, "{}").status, 400);
  EXPECT_EQ(browser.Send("GET", "/").status, 200) << "an error does not end the connection";
}

TEST_F(GatewayCallsTest, RequestsMayBeSentBeforeTheResponseOfTheFirst) {
  HttpClient browser = Connect();
  std::string both;
  for (const char* name : {"objects/a", "objects/b"}) {
    const std::string body = absl::StrCat(R"({"name":")", name, R"("})");
    absl::StrAppend(&both, "POST /graspdb.v1.CatalogService/GetObject HTTP/1.1\r\nHost: localhost:",
                    gateway_->port(), "\r\nContent-Type: ", kJson,
                    "\r\nContent-Length: ", body.size(), "\r\n\r\n", body);
  }
  browser.SendBytes(both);
  EXPECT_THAT(browser.Receive().body, HasSubstr("objects/a"));
  EXPECT_THAT(browser.Receive().body, HasSubstr("objects/b"));
}

TEST_F(GatewayCallsTest, ACallWithoutServerHasAdvice) {
  server_.reset();
  const HttpResponse response = Call("CatalogService/ListObjects", kJson, "{}");
  EXPECT_EQ(response.status, 503);
  EXPECT_THAT(response.body, HasSubstr("start graspdb-server"));
}

}  // namespace
}  // namespace graspdb::testing
