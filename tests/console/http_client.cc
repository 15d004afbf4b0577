#include "tests/console/http_client.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <limits>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace graspdb::testing {

namespace http = boost::beast::http;
using boost::asio::ip::tcp;

HttpClient::HttpClient(std::uint16_t port) : socket_(context_), port_(port) {
  boost::system::error_code error;
  socket_.connect(tcp::endpoint(boost::asio::ip::address_v4::loopback(), port), error);
  EXPECT_FALSE(error) << error.message();
}

HttpResponse HttpClient::Send(const std::string& method, const std::string& target,
                              const HttpFields& fields, const std::string& body) {
  HttpFields all = {{"Host", absl::StrCat("127.0.0.1:", port_)},
                    {"Content-Length", absl::StrCat(body.size())}};
  for (const auto& [name, value] : fields) all[name] = value;
  std::string text = absl::StrCat(method, " ", target, " HTTP/1.1\r\n");
  for (const auto& [name, value] : all) absl::StrAppend(&text, name, ": ", value, "\r\n");
  SendBytes(absl::StrCat(text, "\r\n", body));
  return Receive();
}

HttpResponse HttpClient::Call(const std::string& path, const std::string& content_type,
                              const std::string& body, HttpFields fields) {
  fields.emplace("Content-Type", content_type);
  return Send("POST", path, fields, body);
}

bool HttpClient::SendBytes(std::string_view bytes) {
  boost::system::error_code error;
  boost::asio::write(socket_, boost::asio::buffer(bytes.data(), bytes.size()), error);
  return !error;
}

HttpResponse HttpClient::Receive() {
  http::response_parser<http::string_body> parser;
  parser.body_limit(std::numeric_limits<std::uint64_t>::max());
  boost::system::error_code error;
  http::read(socket_, buffer_, parser, error);
  HttpResponse out;
  if (error) return out;
  out.status = static_cast<int>(parser.get().result_int());
  for (const auto& field : parser.get()) {
    out.fields[absl::AsciiStrToLower(std::string(field.name_string()))] =
        std::string(field.value());
  }
  out.body = parser.get().body();
  return out;
}

std::string HttpClient::ReceiveBytes() {
  if (buffer_.size() > 0) {
    std::string out(static_cast<const char*>(buffer_.data().data()), buffer_.size());
    buffer_.clear();
    return out;
  }
  std::array<char, 65536> bytes = {};
  boost::system::error_code error;
  const std::size_t size = socket_.read_some(boost::asio::buffer(bytes), error);
  return {bytes.data(), size};
}

void HttpClient::Close() {
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace graspdb::testing
