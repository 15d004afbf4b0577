// The first part of a request: method, target and fields.
#pragma once

#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <string_view>

namespace graspdb::console {

using RequestHead = boost::beast::http::request_header<>;

// The value of a field, of the first one with this name in any case; empty if there is none. Views
// of the head.
inline std::string_view Field(const RequestHead& head, std::string_view name) {
  const auto value = head[boost::beast::string_view(name.data(), name.size())];
  return {value.data(), value.size()};
}

// The target without its query: "/console.js".
inline std::string_view Path(const RequestHead& head) {
  const auto target = head.target();
  const std::string_view all(target.data(), target.size());
  return all.substr(0, all.find('?'));
}

}  // namespace graspdb::console
