#include "console/http_connection.h"

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_cat.hpp>
#include <boost/beast/core/stream_traits.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <type_traits>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "console/methods.h"
#include "program/log/request_id.h"

namespace graspdb::console {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;

template <typename Stream>
constexpr bool kIsTls = false;
template <typename Socket>
constexpr bool kIsTls<net::ssl::stream<Socket>> = true;

constexpr char kContinue[] = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr char kLastChunk[] = "0\r\n\r\n";
// For what a peer still sends; the memory is one chunk.
constexpr std::chrono::milliseconds kLingerTime = std::chrono::seconds(3);

std::chrono::milliseconds TransferTime(const HttpLimits& limits, std::size_t bytes) {
  return limits.slow_time + std::chrono::milliseconds(bytes * 1000 / limits.lowest_bytes_per_s);
}

// Why the request's head cannot be read, as status of HTTP; 0: the connection is broken.
int StatusOf(const beast::error_code& error) {
  if (error == http::error::header_limit) return 431;
  if (error == http::error::body_limit) return 413;
  if (error == http::error::end_of_stream || error == http::error::partial_message) return 0;
  return error.category() == make_error_code(http::error::bad_method).category() ? 400 : 0;
}

}  // namespace

template <typename Stream>
HttpConnection<Stream>::HttpConnection(Stream stream, Site& site)
    : stream_(std::move(stream)),
      site_(site),
      deadline_(stream_.get_executor()),
      buffer_(2 * site.limits.max_head_bytes) {
  ++site_.connection_count;
}

template <typename Stream>
HttpConnection<Stream>::~HttpConnection() {
  ReleaseBody();
  --site_.connection_count;
}

template <typename Stream>
void HttpConnection<Stream>::Start() {
  Arm(site_.limits.slow_time);
  if constexpr (kIsTls<Stream>) {
    stream_.async_handshake(net::ssl::stream_base::server, Bound(&Self::OnHandshake));
  } else {
    ReadHead();
  }
}

template <typename Stream>
void HttpConnection<Stream>::OnHandshake(ErrorCode error) {
  if (error) return Abort();
  ReadHead();
}

template <typename Stream>
void HttpConnection<Stream>::Arm(Duration time) {
  deadline_.expires_after(time);
  deadline_.async_wait(Bound(&Self::OnDeadline));
}

template <typename Stream>
void HttpConnection<Stream>::OnDeadline(ErrorCode error) {
  // It may have been armed again after it expired.
  if (error || deadline_.expiry() > std::chrono::steady_clock::now()) return;
  Abort();
}

template <typename Stream>
void HttpConnection<Stream>::Abort() {
  if (phase_ == Phase::kClosed) return;
  phase_ = Phase::kClosed;
  Disarm();
  ErrorCode ignored;
  beast::get_lowest_layer(stream_).close(ignored);
  if (call_ != nullptr) std::exchange(call_, nullptr)->Cancel();
}

template <typename Stream>
void HttpConnection<Stream>::ReadHead() {
  phase_ = Phase::kRequest;
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(site_.limits.max_head_bytes));
  parser_->body_limit(site_.limits.max_body_bytes);
  http::async_read_header(stream_, buffer_, *parser_, Bound(&Self::OnHead));
}

template <typename Stream>
void HttpConnection<Stream>::OnHead(ErrorCode error, std::size_t /*bytes*/) {
  if (phase_ == Phase::kClosed) return;
  plan_ = {};
  has_head_ = false;
  keep_alive_ = false;
  if (const int status = error ? StatusOf(error) : 200; status == 0) {
    Abort();
  } else if (error == http::error::body_limit) {
    RespondError(absl::ResourceExhaustedError(absl::StrCat(
                     "the body is larger than ", site_.limits.max_body_bytes >> 20, " MiB")),
                 status);
  } else if (error) {
    RespondError(absl::InvalidArgumentError("this is no HTTP request, or its head is too long"),
                 status);
  } else {
    Route();
  }
}

template <typename Stream>
void HttpConnection<Stream>::Route() {
  const RequestHead& head = parser_->get().base();
  if (absl::Status source = CheckSource(head, site_.origins); !source.ok()) {
    return RespondError(source, absl::IsUnimplemented(source) ? 505 : 403);
  }
  keep_alive_ = parser_->keep_alive() && parser_->is_done();
  const bool is_head = head.method() == http::verb::head;
  if (head.method() == http::verb::get || is_head) {
    Answer answer = FileAnswer(head, site_.files);
    if (is_head) answer.text.clear();
    if (is_head) answer.bytes = {};
    return Respond(std::move(answer));
  }
  if (head.method() != http::verb::post) {
    return RespondError(absl::UnimplementedError("only GET, HEAD and POST are answered"), 405);
  }
  int http_status = 0;
  if (absl::Status planned = PlanCall(head, &plan_, &http_status); !planned.ok()) {
    return RespondError(planned, http_status);
  }
  keep_alive_ = parser_->keep_alive();
  body_.clear();
  body_start_ = std::chrono::steady_clock::now();
  const std::string_view expect = Field(head, "Expect");
  if (absl::EqualsIgnoreCase(absl::string_view(expect.data(), expect.size()), "100-continue")) {
    Write(kContinue, {}, {}, &Self::ReadBody);
  } else {
    ReadBody();
  }
}

template <typename Stream>
void HttpConnection<Stream>::ReadBody() {
  if (parser_->is_done()) return Call();
  // The peer has a time for the next bytes, and one for all so far.
  const Duration spent =
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - body_start_);
  Arm(std::min(site_.limits.slow_time, TransferTime(site_.limits, body_.size()) - spent));
  parser_->get().body().data = chunk_.data();
  parser_->get().body().size = chunk_.size();
  parser_->get().body().more = true;
  http::async_read_some(stream_, buffer_, *parser_, Bound(&Self::OnBody));
}

template <typename Stream>
void HttpConnection<Stream>::OnBody(ErrorCode error, std::size_t /*bytes*/) {
  if (phase_ == Phase::kClosed) return;
  if (error == http::error::need_buffer) error = {};  // the chunk is full
  if (error) {
    keep_alive_ = false;
    const int status = StatusOf(error);
    if (status == 0) return Abort();
    return RespondError(absl::ResourceExhaustedError("the body is too large, or no HTTP"), status);
  }
  const std::size_t bytes = chunk_.size() - parser_->get().body().size;
  if (!CountBody(bytes)) {
    keep_alive_ = false;
    body_ = {};
    ReleaseBody();
    return RespondError(absl::ResourceExhaustedError(
        "the console has no memory left for another body; try again later"));
  }
  body_.append(chunk_.data(), bytes);
  ReadBody();
}

template <typename Stream>
bool HttpConnection<Stream>::CountBody(std::size_t bytes) {
  counted_bytes_ += bytes;
  return site_.body_byte_count.fetch_add(bytes) + bytes <= site_.limits.max_bodies_bytes;
}

template <typename Stream>
void HttpConnection<Stream>::ReleaseBody() {
  site_.body_byte_count -= std::exchange(counted_bytes_, 0);
}

template <typename Stream>
void HttpConnection<Stream>::Call() {
  Disarm();
  std::string body = std::exchange(body_, {});
  if (plan_.format.is_stream) {
    const absl::StatusOr<std::string_view> message = OnlyMessage(body);
    if (!message.ok()) return RespondError(message.status());
    body = std::string(*message);
  }
  absl::StatusOr<std::string> message =
      RequestBytes(*plan_.method, plan_.format.encoding, std::move(body));
  if (!message.ok()) return RespondError(message.status());
  plan_.request.message = *std::move(message);
  phase_ = Phase::kResponse;
  call_ = site_.upstream.Start(
      std::move(plan_.request), [self = this->shared_from_this()](UpstreamEvent event) {
        net::post(self->stream_.get_executor(),
                  [self, event = std::move(event)]() mutable { self->OnEvent(std::move(event)); });
      });
  WatchPeer();
}

template <typename Stream>
void HttpConnection<Stream>::OnEvent(UpstreamEvent event) {
  if (event.end) call_ = nullptr;
  if (event.end) ReleaseBody();
  if (phase_ == Phase::kClosed) return;
  if (plan_.format.is_stream) {
    OnStream(std::move(event));
  } else {
    OnUnary(std::move(event));
  }
}

template <typename Stream>
void HttpConnection<Stream>::OnUnary(UpstreamEvent event) {
  if (!event.end) return;  // a unary call has nothing before its end
  absl::Status status = event.end->status;
  std::string text;
  if (status.ok()) {
    absl::StatusOr<std::string> made = ResponseText(
        *plan_.method, plan_.format.encoding, std::move(event.message).value_or(std::string()));
    status = made.status();
    if (made.ok()) text = *std::move(made);
  }
  Answer answer = status.ok() ? Answer{.head = MakeHead(200, ContentType(plan_.format)),
                                       .text = std::move(text)}
                              : ErrorAnswer(HttpStatus(status.code()), status);
  if (!event.end->request_id.empty()) answer.head.set(kRequestIdKey, event.end->request_id);
  Respond(std::move(answer));
}

template <typename Stream>
void HttpConnection<Stream>::OnStream(UpstreamEvent event) {
  std::string head;
  if (!std::exchange(has_head_, true)) {
    ResponseHead fields = MakeHead(200, ContentType(plan_.format));
    fields.set(http::field::transfer_encoding, "chunked");
    fields.set(http::field::connection, keep_alive_ ? "keep-alive" : "close");
    head = HeadText(fields);
  }
  std::string body;
  bool has_ended = event.end.has_value();
  absl::Status status = event.end ? event.end->status : absl::OkStatus();
  if (event.message) {
    absl::StatusOr<std::string> text =
        ResponseText(*plan_.method, plan_.format.encoding, *std::move(event.message));
    if (text.ok()) body = Envelope(*text);
    if (!text.ok()) status = text.status();
    if (!text.ok() && call_ != nullptr) std::exchange(call_, nullptr)->Cancel();
    has_ended = has_ended || !text.ok();
  }
  if (has_ended) body += EndOfStream(status);
  absl::StrAppendFormat(&head, "%x\r\n", body.size());
  absl::StrAppend(&body, "\r\n", has_ended ? kLastChunk : "");
  Write(std::move(head), std::move(body), {},
        has_ended ? &Self::EndResponse : &Self::ReadNextMessage);
}

template <typename Stream>
void HttpConnection<Stream>::ReadNextMessage() {
  Disarm();
  if (call_ != nullptr) call_->Next();
}

template <typename Stream>
void HttpConnection<Stream>::WatchPeer() {
  // What is there already belongs to the next request, so that the peer is not gone.
  if (peer_ == Peer::kWatched || buffer_.size() > 0) return;
  peer_ = Peer::kWatched;
  stream_.async_read_some(buffer_.prepare(1024), Bound(&Self::OnPeer));
}

template <typename Stream>
void HttpConnection<Stream>::OnPeer(ErrorCode error, std::size_t bytes) {
  peer_ = Peer::kUnwatched;
  if (error) return Abort();
  if (phase_ == Phase::kLingering) return OnLinger(error, 0);
  buffer_.commit(bytes);
  if (phase_ == Phase::kIdle) ReadHead();
}

template <typename Stream>
void HttpConnection<Stream>::RespondError(const absl::Status& error, int http_status) {
  if (plan_.format.is_stream && http_status == 0) {
    return OnEvent({.end = UpstreamEvent::End{.status = error, .request_id = {}}});
  }
  Respond(ErrorAnswer(http_status == 0 ? HttpStatus(error.code()) : http_status, error));
}

template <typename Stream>
void HttpConnection<Stream>::Respond(Answer answer) {
  phase_ = Phase::kResponse;
  const std::size_t size = answer.text.size() + answer.bytes.size();
  if (answer.head.result() != http::status::not_modified) {
    answer.head.set(http::field::content_length, std::to_string(size));
  }
  answer.head.set(http::field::connection, keep_alive_ ? "keep-alive" : "close");
  Write(HeadText(answer.head), std::move(answer.text), answer.bytes, &Self::EndResponse);
}

template <typename Stream>
void HttpConnection<Stream>::Write(std::string head, std::string body, std::string_view bytes,
                                   void (Self::*next)()) {
  out_head_ = std::move(head);
  out_body_ = std::move(body);
  after_write_ = next;
  Arm(TransferTime(site_.limits, out_body_.size() + bytes.size()));
  const std::array<net::const_buffer, 3> parts = {net::buffer(out_head_), net::buffer(out_body_),
                                                  net::buffer(bytes.data(), bytes.size())};
  net::async_write(stream_, parts, Bound(&Self::OnWritten));
}

template <typename Stream>
void HttpConnection<Stream>::OnWritten(ErrorCode error, std::size_t /*bytes*/) {
  if (phase_ == Phase::kClosed) return;
  if (error) return Abort();
  out_body_ = {};
  (this->*after_write_)();
}

template <typename Stream>
void HttpConnection<Stream>::EndResponse() {
  ReleaseBody();
  if (!keep_alive_) return Linger();
  Arm(site_.limits.idle_time);
  phase_ = Phase::kIdle;
  if (peer_ == Peer::kUnwatched) ReadHead();
}

template <typename Stream>
void HttpConnection<Stream>::Linger() {
  phase_ = Phase::kLingering;
  Arm(std::min(kLingerTime, site_.limits.slow_time));
  ErrorCode ignored;
  auto& socket = beast::get_lowest_layer(stream_);
  socket.shutdown(std::remove_reference_t<decltype(socket)>::shutdown_send, ignored);
  if (peer_ == Peer::kUnwatched) OnLinger({}, 0);
}

template <typename Stream>
void HttpConnection<Stream>::OnLinger(ErrorCode error, std::size_t /*bytes*/) {
  if (phase_ == Phase::kClosed) return;
  if (error) return Abort();
  beast::get_lowest_layer(stream_).async_read_some(net::buffer(chunk_), Bound(&Self::OnLinger));
}

template class HttpConnection<net::ip::tcp::socket>;
template class HttpConnection<net::ssl::stream<net::ip::tcp::socket>>;
template class HttpConnection<net::local::stream_protocol::socket>;

}  // namespace graspdb::console
