// What the gateway refuses, and what one connection may take.
#include <gmock/gmock.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "tests/console/gateway_fixture.h"
#include "tests/testing/certificates.h"

namespace graspdb::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kListObjects[] = "/graspdb.v1.CatalogService/ListObjects";
constexpr char kWatchCatalog[] = "/graspdb.v1.ChangeService/WatchCatalog";

// Calls that end when they are cancelled, or as the test decides.
class ScriptedUpstream : public console::Upstream {
 public:
  class Call : public console::UpstreamCall {
   public:
    explicit Call(OnEvent on_event) : on_event_(std::move(on_event)) {}
    void Next() override {
      const std::scoped_lock lock(mutex_);
      ++next_count_;
      changed_.notify_all();
    }
    void Cancel() override { End(absl::CancelledError("cancelled")); }
    void End(const absl::Status& status, std::optional<std::string> message = std::nullopt) {
      OnEvent on_event;
      {
        const std::scoped_lock lock(mutex_);
        on_event = std::exchange(on_event_, nullptr);
        was_cancelled_ = absl::IsCancelled(status);
        changed_.notify_all();
      }
      if (!on_event) return;
      on_event({.message = std::move(message),
                .end = console::UpstreamEvent::End{.status = status, .request_id = {}}});
    }
    void Send(std::string message) {
      OnEvent on_event;
      {
        const std::scoped_lock lock(mutex_);
        on_event = on_event_;
      }
      on_event({.message = std::move(message)});
    }
    int next_count() {
      const std::scoped_lock lock(mutex_);
      return next_count_;
    }
    void AwaitNext(int count) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return next_count_ >= count; });
    }
    void AwaitCancel() {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return was_cancelled_; });
    }

   private:
    std::mutex mutex_;
    std::condition_variable changed_;
    OnEvent on_event_;
    int next_count_ = 0;
    bool was_cancelled_ = false;
  };

  ~ScriptedUpstream() override {
    for (const auto& call : all_) call->Cancel();
  }

  std::shared_ptr<console::UpstreamCall> Start(console::UpstreamRequest /*request*/,
                                               OnEvent on_event) override {
    auto call = std::make_shared<Call>(std::move(on_event));
    std::unique_lock lock(mutex_);
    if (answer_) {
      const std::string answer = *answer_;
      lock.unlock();
      call->End(absl::OkStatus(), answer);
      return call;
    }
    calls_.push_back(call);
    all_.push_back(call);
    changed_.notify_all();
    return call;
  }
  // Answers all calls at once.
  void Answer(std::string message) {
    const std::scoped_lock lock(mutex_);
    answer_ = std::move(message);
  }
  // The next call.
  std::shared_ptr<Call> Await() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !calls_.empty(); });
    auto out = calls_.front();
    calls_.pop_front();
    return out;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Call>> calls_;  // not yet taken by Await()
  std::vector<std::shared_ptr<Call>> all_;
  std::optional<std::string> answer_;
};

class NoServer : public ::testing::Test {};

class GatewayHttpTest : public ConsoleTest<NoServer> {
 protected:
  void SetUp() override { Start(); }
  void Start() {
    auto upstream = std::make_unique<ScriptedUpstream>();
    upstream_ = upstream.get();
    StartGateway(std::move(upstream));
  }
  std::string Head(const std::string& path, const std::string& type, const std::string& rest) {
    return absl::StrCat("POST ", path, " HTTP/1.1\r\nHost: localhost:", gateway_->port(),
                        "\r\nContent-Type: ", type, "\r\n", rest);
  }
  void AwaitConnections(int count) const {
    while (gateway_->connection_count() != count) absl::SleepFor(absl::Milliseconds(1));
  }

  ScriptedUpstream* upstream_ = nullptr;
};

TEST_F(GatewayHttpTest, ServesThePage) {
  const HttpResponse page = Connect().Send("GET", "/?scene=1");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<!doctype html>");
  EXPECT_EQ(page.Field("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.Field("content-security-policy"),
              AllOf(HasSubstr("script-src 'self'"),
                    HasSubstr("require-trusted-types-for 'script'; trusted-types mesh-worker"),
                    Not(HasSubstr("unsafe"))));
  EXPECT_EQ(page.Field("x-content-type-options"), "nosniff");
  EXPECT_EQ(page.Field("set-cookie"), "");
  EXPECT_EQ(page.Field("access-control-allow-origin"), "");
  EXPECT_EQ(Connect().Send("GET", "/console.js").body, "let a = 1;");
  const HttpResponse compressed =
      Connect().Send("GET", "/console.js", {{"Accept-Encoding", "br, gzip"}});
  EXPECT_EQ(compressed.body, "compressed");
  EXPECT_EQ(compressed.Field("content-encoding"), "gzip");
  EXPECT_EQ(Connect().Send("GET", "/", {{"If-None-Match", "\"1\""}}).status, 304);
}

TEST_F(GatewayHttpTest, AHeadHasNoBody) {
  HttpClient browser = Connect();
  browser.SendBytes(absl::StrCat("HEAD / HTTP/1.1\r\nHost: localhost:", gateway_->port(),
                                 "\r\nConnection: close\r\n\r\n"));
  std::string all;
  for (std::string bytes; !(bytes = browser.ReceiveBytes()).empty();) all += bytes;
  EXPECT_THAT(all, ::testing::EndsWith("\r\n\r\n"));
}

TEST_F(GatewayHttpTest, OtherFilesDoNotExist) {
  for (const char* path :
       {"/none", "/..", "/../etc/passwd", "//", "/console.js/", "/%2e%2e/x", "*", "/index.html"}) {
    EXPECT_EQ(Connect().Send("GET", path).status, 404) << path;
  }
  const HttpResponse method = Connect().Send("GET", kListObjects);
  EXPECT_EQ(method.status, 405);
  EXPECT_EQ(method.Field("allow"), "POST");
  EXPECT_EQ(Connect().Send("OPTIONS", kListObjects).status, 405);
  EXPECT_EQ(Connect().Send("DELETE", "/").status, 405);
  EXPECT_EQ(Connect().Send("POST", "/", {{"Content-Type", kJson}}, "{}").status, 404);
}

TEST_F(GatewayHttpTest, RefusesOtherHostsAndSites) {
  const auto status = [&](HttpFields fields) {
    fields.emplace("Content-Type", kJson);
    return Connect().Send("POST", kListObjects, fields, "{}").status;
  };
  upstream_->Answer("");
  EXPECT_EQ(status({}), 200);
  EXPECT_EQ(status({{"Host", "evil.example"}}), 403);
  EXPECT_EQ(status({{"Host", absl::StrCat("evil.example:", gateway_->port())}}), 403);
  EXPECT_EQ(status({{"Host", ""}}), 403);
  EXPECT_EQ(status({{"Origin", "http://evil.example"}}), 403);
  EXPECT_EQ(status({{"Origin", "null"}}), 403);
  EXPECT_EQ(status({{"Sec-Fetch-Site", "cross-site"}}), 403);
  EXPECT_EQ(status({{"Sec-Fetch-Site", "same-site"}}), 403);
  EXPECT_EQ(status({{"Origin", absl::StrCat("http://127.0.0.1:", gateway_->port())},
                    {"Sec-Fetch-Site", "same-origin"}}),
            200);
  EXPECT_EQ(Connect().Send("GET", "/", {{"Host", "evil.example"}}).status, 403);
  EXPECT_EQ(Connect().Send("GET", "/console.js", {{"Sec-Fetch-Site", "cross-site"}}).status, 403);
  EXPECT_EQ(
      Connect()
          .Send("GET", "/", {{"Sec-Fetch-Site", "cross-site"}, {"Sec-Fetch-Mode", "navigate"}})
          .status,
      200)
      << "a link from elsewhere opens the page";
}

TEST_F(GatewayHttpTest, RefusesWhatIsNoRequest) {
  const auto answer = [&](const std::string& bytes) {
    HttpClient client = Connect();
    client.SendBytes(bytes);
    const int status = client.Receive().status;
    EXPECT_TRUE(client.IsClosed()) << bytes.substr(0, 60);
    return status;
  };
  const std::string host = absl::StrCat("Host: localhost:", gateway_->port(), "\r\n");
  EXPECT_EQ(answer("\r\n\r\n"), 400);
  EXPECT_THAT(answer("GET / HTTP/3.0\r\n\r\n"), AnyOf(400, 505));
  EXPECT_EQ(answer("\x16\x03\x01\x02\x01\x01\x01\r\n\r\n"), 400) << "TLS";
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n\r\n"), 403);
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n" + host + host + "\r\n"), 403);
  EXPECT_EQ(answer("GET / HTTP/1.0\r\n" + host + "\r\n"), 505);
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'x') + "\r\n\r\n"),
            431);
  EXPECT_EQ(answer(Head(kListObjects, kJson, "Content-Length: x\r\n\r\n")), 400);
  EXPECT_EQ(answer(Head(kListObjects, kJson, "Transfer-Encoding: chunked\r\n\r\nzz\r\n")), 400);
  EXPECT_EQ(answer(Head(kListObjects, kJson,
                        "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n{}")),
            400);
}

TEST_F(GatewayHttpTest, RefusesLargeBodies) {
  gateway_options_.limits.max_body_bytes = 1 << 20;
  Start();
  HttpClient client = Connect();
  // Refused by the length alone.
  client.SendBytes(Head(kListObjects, kProto, "Content-Length: 100000000\r\n\r\n"));
  const HttpResponse large = client.Receive();
  EXPECT_EQ(large.status, 413);
  EXPECT_THAT(large.body, HasSubstr("larger than 1 MiB"));
  EXPECT_EQ(large.Field("connection"), "close");

  HttpClient chunked = Connect();
  chunked.SendBytes(Head(kListObjects, kProto, "Transfer-Encoding: chunked\r\n\r\n"));
  const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
  for (int i = 0; i < 17; ++i) chunked.SendBytes(chunk);
  EXPECT_EQ(chunked.Receive().status, 413);

  upstream_->Answer("");
  const HttpResponse allowed = Connect().Call(kListObjects, kProto, std::string(1 << 20, 'x'));
  EXPECT_EQ(allowed.status, 200);
}

TEST_F(GatewayHttpTest, AllBodiesTogetherAreLimited) {
  gateway_options_.limits.max_bodies_bytes = 100'000;
  Start();
  const HttpResponse refused = Connect().Call(kListObjects, kProto, std::string(100'001, 'x'));
  EXPECT_EQ(refused.status, 429);
  EXPECT_THAT(refused.body, HasSubstr("memory"));
  upstream_->Answer("");
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(Connect().Call(kListObjects, kProto, std::string(99'000, 'x')).status, 200)
        << "memory is free again";
  }
}

TEST_F(GatewayHttpTest, AClientMayWaitBeforeItSendsTheBody) {
  upstream_->Answer("");
  HttpClient client = Connect();
  client.SendBytes(Head(kListObjects, kJson, "Content-Length: 2\r\nExpect: 100-continue\r\n\r\n"));
  EXPECT_EQ(client.ReceiveBytes(), "HTTP/1.1 100 Continue\r\n\r\n");
  client.SendBytes("{}");
  EXPECT_EQ(client.Receive().status, 200);
}

TEST_F(GatewayHttpTest, FurtherConnectionsAreClosed) {
  gateway_options_.limits.max_connections = 2;
  Start();
  HttpClient first = Connect();
  HttpClient second = Connect();
  AwaitConnections(2);
  EXPECT_TRUE(Connect().IsClosed());
  EXPECT_EQ(first.Send("GET", "/").status, 200);
  first.Close();
  AwaitConnections(1);
  EXPECT_EQ(Connect().Send("GET", "/").status, 200) << "its place is free";
  EXPECT_EQ(second.Send("GET", "/").status, 200);
}

TEST_F(GatewayHttpTest, SlowClientsLoseTheirConnection) {
  gateway_options_.limits.slow_time = std::chrono::milliseconds(100);
  gateway_options_.limits.idle_time = std::chrono::milliseconds(100);
  gateway_options_.limits.lowest_bytes_per_s = 1 << 30;
  Start();
  EXPECT_TRUE(Connect().IsClosed()) << "sends nothing";
  HttpClient head = Connect();
  head.SendBytes("POST / HTTP/1.1\r\n");
  EXPECT_TRUE(head.IsClosed());
  HttpClient body = Connect();
  body.SendBytes(Head(kListObjects, kJson, "Content-Length: 10\r\n\r\n{"));
  EXPECT_TRUE(body.IsClosed());
  HttpClient idle = Connect();
  EXPECT_EQ(idle.Send("GET", "/").status, 200);
  EXPECT_TRUE(idle.IsClosed());
  // Takes nothing of a response that is larger than what the kernel keeps.
  upstream_->Answer(std::string(64 << 20, 'x'));
  HttpClient reader = Connect();
  reader.SendBytes(Head(kListObjects, kProto, "Content-Length: 0\r\n\r\n"));
  AwaitConnections(0);
  // A call itself may take long.
  Start();
  HttpClient caller = Connect();
  caller.SendBytes(Head(kListObjects, kProto, "Content-Length: 0\r\n\r\n"));
  const auto call = upstream_->Await();
  absl::SleepFor(absl::Milliseconds(300));
  call->End(absl::OkStatus(), "answer");
  EXPECT_EQ(caller.Receive().body, "answer");
}

TEST_F(GatewayHttpTest, ACallEndsWithItsConnection) {
  for (const auto& [path, type, body] :
       {std::tuple{kListObjects, kProto, std::string()},
        std::tuple{kWatchCatalog, kProtoStream, std::string(5, '\0')}}) {
    HttpClient client = Connect();
    client.SendBytes(absl::StrCat(Head(path, type, absl::StrCat("Content-Length: ", body.size())),
                                  "\r\n\r\n", body));
    const auto call = upstream_->Await();
    client.Close();
    call->AwaitCancel();
  }
  AwaitConnections(0);
}

TEST_F(GatewayHttpTest, AStreamIsReadAsFastAsTheBrowserTakesIt) {
  HttpClient client = Connect();
  client.SendBytes(absl::StrCat(Head(kWatchCatalog, kProtoStream, "Content-Length: 5\r\n\r\n"),
                                std::string(5, '\0')));
  const auto call = upstream_->Await();
  // More than the kernel keeps, so that it cannot be written before it is read.
  const std::string message(64 << 20, 'x');
  call->Send(message);
  std::string received = client.ReceiveBytes();
  EXPECT_EQ(call->next_count(), 0) << "the message is not written yet";
  while (received.size() < message.size()) received += client.ReceiveBytes();
  call->AwaitNext(1);
  call->Send("last");
  while (received.find("last", message.size()) == std::string::npos) {
    received += client.ReceiveBytes();
  }
  call->AwaitNext(2);
  call->End(absl::OkStatus());
  while (!received.ends_with("0\r\n\r\n")) received += client.ReceiveBytes();
  EXPECT_EQ(client.Send("GET", "/").status, 200) << "the connection stays";
}

TEST_F(GatewayHttpTest, CallsInProgressEndWithTheGateway) {
  HttpClient client = Connect();
  client.SendBytes(Head(kListObjects, kProto, "Content-Length: 0\r\n\r\n"));
  const auto call = upstream_->Await();
  gateway_.reset();
  call->AwaitCancel();
  EXPECT_TRUE(client.IsClosed());
}

TEST_F(GatewayHttpTest, OtherMachinesNeedEncryption) {
  const auto check = [](const console::GatewayOptions& options) {
    return console::CheckOptions(options);
  };
  EXPECT_THAT(check({.listen = "0.0.0.0:8080"}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--behind-proxy")));
  EXPECT_THAT(check({.listen = "0.0.0.0:8080", .behind_proxy = true}), IsOk());
  EXPECT_THAT(check({.listen = "x"}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--listen")));
  EXPECT_THAT(check({.tls_cert = "x"}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("give both")));
  EXPECT_THAT(check({.tls_cert = "/none.pem", .tls_key = "/none.key"}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--tls-cert")));
}

}  // namespace
}  // namespace graspdb::testing
