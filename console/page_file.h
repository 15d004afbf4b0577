// Files of the page, which are part of the program.
#pragma once

#include <span>
#include <string_view>

namespace graspdb::console {

// The views outlive whoever uses the file.
struct PageFile {
  std::string_view path;  // "/console.js"; that of the page itself is "/"
  std::string_view content_type;
  std::string_view bytes;
  std::string_view gzip;  // the same, compressed; may be empty
  std::string_view etag;  // with its quotes
};

// All files of the page, as built by console/page.
std::span<const PageFile> PageFiles();

}  // namespace graspdb::console
