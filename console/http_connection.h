// One connection of a browser.
#pragma once

#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "console/answer.h"
#include "console/call_plan.h"
#include "console/site.h"

namespace graspdb::console {

// Reads requests and answers them, one after the other, until one of the two ends it. Keeps itself
// while it does. Its handlers run on the stream's executor, which is a strand.
//
// Stream: boost::asio's TCP socket, ssl::stream of one, or a local socket.
template <typename Stream>
class HttpConnection : public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  HttpConnection(Stream stream, Site& site);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  // To be called on the executor.
  void Start();

 private:
  using Self = HttpConnection;
  using ErrorCode = boost::beast::error_code;
  using Duration = std::chrono::milliseconds;
  using Parser = boost::beast::http::request_parser<boost::beast::http::buffer_body>;

  template <typename Handler>
  auto Bound(Handler handler) {
    return [self = this->shared_from_this(), handler](auto... arguments) {
      ((*self).*handler)(arguments...);
    };
  }

  // Closes the connection after that time, unless called again before.
  void Arm(Duration time);
  void Disarm() { deadline_.cancel(); }
  void OnDeadline(ErrorCode error);
  // Closes it now, and ends the call.
  void Abort();

  void OnHandshake(ErrorCode error);
  void ReadHead();
  void OnHead(ErrorCode error, std::size_t bytes);
  void Route();
  void ReadBody();
  void OnBody(ErrorCode error, std::size_t bytes);
  bool CountBody(std::size_t bytes);
  void ReleaseBody();

  void Call();
  void OnEvent(UpstreamEvent event);
  void OnUnary(UpstreamEvent event);
  void OnStream(UpstreamEvent event);
  // Notices that the browser is gone while a call is in progress.
  void WatchPeer();
  void OnPeer(ErrorCode error, std::size_t bytes);

  // Of a call: as the format of its method needs it.
  void RespondError(const absl::Status& error, int http_status = 0);
  void Respond(Answer answer);
  void Write(std::string head, std::string body, std::string_view bytes, void (Self::*next)());
  void OnWritten(ErrorCode error, std::size_t bytes);
  void ReadNextMessage();
  void EndResponse();
  // Lets the peer read the response before the connection is closed: reads what it still sends.
  void Linger();
  void OnLinger(ErrorCode error, std::size_t bytes);

  Stream stream_;
  Site& site_;
  boost::asio::steady_timer deadline_;
  boost::beast::flat_buffer buffer_;  // what was read
  std::optional<Parser> parser_;      // of the request
  bool keep_alive_ = false;
  CallPlan plan_;
  std::array<char, 16 << 10> chunk_ = {};  // of the body
  std::string body_;
  std::size_t counted_bytes_ = 0;  // of the body, in site_
  std::chrono::steady_clock::time_point body_start_;
  std::shared_ptr<UpstreamCall> call_;  // in progress
  bool has_head_ = false;               // of a streamed response, was sent
  std::string out_head_;                // what is written: three parts
  std::string out_body_;
  void (Self::*after_write_)() = nullptr;
  enum class Peer { kUnwatched, kWatched } peer_ = Peer::kUnwatched;
  enum class Phase { kRequest, kResponse, kIdle, kLingering, kClosed } phase_ = Phase::kRequest;
};

}  // namespace graspdb::console
