// Files in place of those of console/page.
#pragma once

#include <array>

#include "console/page_file.h"

namespace graspdb::testing {

inline constexpr std::array<console::PageFile, 2> kSamplePage = {{
    {"/", "text/html; charset=utf-8", "<!doctype html>", "", "\"1\""},
    {"/console.js", "text/javascript", "let a = 1;", "compressed", "\"2\""},
}};

}  // namespace graspdb::testing
