#include "lab/experiment/report/page_style.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"

namespace graspdb::client {
namespace {

using Colours = std::array<std::pair<absl::string_view, absl::string_view>, 8>;

// Those of Okabe and Ito, which people with colour blindness tell apart.
constexpr Colours kLight = {{{"--ground", "#ffffff"},
                             {"--text", "#1a1c20"},
                             {"--faint", "#d5d8dd"},
                             {"--c0", "#0072b2"},
                             {"--c1", "#d55e00"},
                             {"--c2", "#008060"},
                             {"--c3", "#b0508a"},
                             {"--c4", "#8a6d00"}}};
constexpr Colours kDark = {{{"--ground", "#14161a"},
                            {"--text", "#e6e8eb"},
                            {"--faint", "#3a3f47"},
                            {"--c0", "#56b4e9"},
                            {"--c1", "#f0883e"},
                            {"--c2", "#2cc295"},
                            {"--c3", "#e5a3c6"},
                            {"--c4", "#e0c840"}}};

constexpr char kIfDark[] = "@media (prefers-color-scheme: dark) {";

constexpr char kPageRules[] =
    R"(body { background: var(--ground); color: var(--text); font: 15px/1.5 system-ui, sans-serif;
  max-width: 72rem; margin: 0 auto; padding: 1rem 1.5rem 4rem; }
h2 { margin-top: 3rem; border-top: 1px solid var(--faint); padding-top: 1rem; }
h3 { margin: 2rem 0 0.3rem; }
p { max-width: 46rem; margin: 0.3rem 0 0.8rem; }
pre { overflow-x: auto; padding: 0.7rem; border: 1px solid var(--faint); white-space: pre-wrap;
  overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.25rem 0.7rem; border-bottom: 1px solid var(--faint); text-align: right; }
th:first-child, td:first-child { text-align: left; }
figure { display: inline-block; margin: 0.5rem 1rem 1rem 0; vertical-align: top; max-width: 100%; }
figcaption { font-size: 13px; max-width: 300px; }
)";

constexpr char kPlotRules[] = R"(.plot { color: var(--text); max-width: 100%; height: auto; }
.plot text { font: 12px system-ui, sans-serif; fill: currentColor; }
.f0 { fill: var(--c0); } .f1 { fill: var(--c1); } .f2 { fill: var(--c2); }
.f3 { fill: var(--c3); } .f4 { fill: var(--c4); }
.s0 { stroke: var(--c0); } .s1 { stroke: var(--c1); stroke-dasharray: 7 3; }
.s2 { stroke: var(--c2); stroke-dasharray: 2 3; } .s3 { stroke: var(--c3); }
.s4 { stroke: var(--c4); } .st { stroke: currentColor; stroke-opacity: 0.6; }
.line { fill: none; stroke-width: 2; }
.dots { fill: none; stroke-linecap: round; stroke-dasharray: none; }
.axis { fill: none; stroke: currentColor; }
.grid { fill: none; stroke: var(--faint); }
.mark { fill: none; stroke: currentColor; stroke-width: 2; }
.key0 { color: var(--c0); } .key1 { color: var(--c1); }
)";

std::string Declared(const Colours& colours) {
  std::string out = ":root {";
  for (const auto& [name, value] : colours) absl::StrAppend(&out, " ", name, ": ", value, ";");
  return out + " }";
}

std::string PlotRulesIn(const Colours& colours) {
  std::string out = absl::StrCat(".plot { background: var(--ground); }\n", kPlotRules);
  for (const auto& [name, value] : colours) {
    absl::StrReplaceAll({{absl::StrCat("var(", name, ")"), value}}, &out);
  }
  return out;
}

}  // namespace

std::string PageStyle() {
  return absl::StrCat(":root { color-scheme: light dark; }\n", Declared(kLight), "\n", kIfDark, " ",
                      Declared(kDark), " }\n", kPageRules, kPlotRules);
}

std::string PlotFileStyle() {
  return absl::StrCat(PlotRulesIn(kLight), kIfDark, "\n", PlotRulesIn(kDark), "}\n");
}

}  // namespace graspdb::client
