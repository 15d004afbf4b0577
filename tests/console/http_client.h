// A client of HTTP that can also send what no client should.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace graspdb::testing {

struct HttpResponse {
  int status = 0;                             // 0: the connection ended before a response
  std::map<std::string, std::string> fields;  // names in lower case
  std::string body;

  std::string Field(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
  }
};

using HttpFields = std::map<std::string, std::string>;

// One connection to this machine.
class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port);

  // A request of HTTP/1.1 with Host and Content-Length; `fields` replace them.
  HttpResponse Send(const std::string& method, const std::string& target,
                    const HttpFields& fields = {}, const std::string& body = "");
  // A call: POST.
  HttpResponse Call(const std::string& path, const std::string& content_type,
                    const std::string& body, HttpFields fields = {});

  // False if the peer has closed the connection.
  bool SendBytes(std::string_view bytes);
  HttpResponse Receive();
  // The next bytes of a response, at least one; empty at the end of the connection.
  std::string ReceiveBytes();
  // Whether the peer closes the connection without another byte; waits for one of the two.
  bool IsClosed() { return ReceiveBytes().empty(); }
  void Close();

 private:
  boost::asio::io_context context_;
  boost::asio::ip::tcp::socket socket_;
  boost::beast::flat_buffer buffer_;
  std::uint16_t port_;
};

}  // namespace graspdb::testing
