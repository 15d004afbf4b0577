#include <gtest/gtest.h>

#include <string>

#include "program/settings_file.h"

namespace graspdb {
namespace {

// The error of these arguments; empty for one that names no command.
std::string UnknownIn(const std::string& arguments) {
  CLI::App app("A program.", "graspdb");
  std::string server;
  std::string set;
  app.add_option("--server", server);
  app.add_subcommand("import")->fallthrough()->add_option("SET", set)->required();
  CLI::App* objects = app.add_subcommand("objects");
  objects->fallthrough()->require_subcommand(1);
  objects->add_subcommand("list")->fallthrough();
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError&) {
    return UnknownCommandError(app);
  }
  return "parsed";
}

TEST(UnknownCommandTest, NamesTheWordAndTheNearestCommand) {
  EXPECT_EQ(UnknownIn("impot a.graspdb"),
            "there is no command impot; the nearest one is import; see graspdb --help");
  EXPECT_EQ(UnknownIn("paint"), "there is no command paint; see graspdb --help");
  EXPECT_EQ(UnknownIn("objects lst"),
            "there is no command lst; the nearest one is list; see graspdb objects --help");
}

TEST(UnknownCommandTest, OtherErrorsAreLeftToTheParser) {
  EXPECT_EQ(UnknownIn("import"), "");
  EXPECT_EQ(UnknownIn("import a b"), "");
  EXPECT_EQ(UnknownIn("objects"), "");
  EXPECT_EQ(UnknownIn("--colour import a"), "");
  EXPECT_EQ(UnknownIn("--colour"), "");
}

}  // namespace
}  // namespace graspdb
