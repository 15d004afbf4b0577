#include "tests/testing/scrape.h"

#include <asio/connect.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <string_view>

namespace graspdb::testing {
namespace {

constexpr std::string_view kHelp = "# HELP ";
constexpr std::string_view kType = "# TYPE ";

// "name" and "the rest" of "name the rest".
std::pair<std::string, std::string> Split(std::string_view text) {
  const std::size_t space = text.find(' ');
  return {std::string(text.substr(0, space)), std::string(text.substr(space + 1))};
}

}  // namespace

std::string HttpGet(const std::string& address, const std::string& path) {
  asio::io_context context;
  asio::ip::tcp::socket socket(context);
  asio::error_code error;
  const std::size_t colon = address.rfind(':');
  const int port = std::atoi(address.c_str() + colon + 1);
  socket.connect({asio::ip::make_address(address.substr(0, colon), error),
                  static_cast<asio::ip::port_type>(port)},
                 error);
  const std::string request = "GET " + path + " HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n";
  if (!error) asio::write(socket, asio::buffer(request), error);
  std::string out;
  if (!error) asio::read(socket, asio::dynamic_buffer(out), error);
  return out;
}

std::map<std::string, MetricText> MetricsIn(const std::string& response) {
  std::map<std::string, MetricText> out;
  std::istringstream lines(response);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view text = line;
    if (text.starts_with(kHelp)) {
      const auto [name, help] = Split(text.substr(kHelp.size()));
      out[name].help = help;
    } else if (text.starts_with(kType)) {
      const auto [name, type] = Split(text.substr(kType.size()));
      out[name].type = type;
    }
  }
  return out;
}

std::map<std::string, MetricText> MetricsInDocument(const std::string& path,
                                                    const std::string& section) {
  std::map<std::string, MetricText> out;
  std::ifstream file(path);
  const std::regex row(R"(\| `([a-z_]+)` \| ([a-z]+) \|[^|]*\| (.*) \|)");
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## " + section;
    std::smatch match;
    if (inside && std::regex_match(line, match, row)) out[match[1]] = {match[2], match[3]};
  }
  return out;
}

double ValueOf(const std::string& response, const std::string& series) {
  const std::size_t found = response.find("\n" + series + " ");
  if (found == std::string::npos) return -1;
  return std::strtod(response.c_str() + found + series.size() + 2, nullptr);
}

}  // namespace graspdb::testing
