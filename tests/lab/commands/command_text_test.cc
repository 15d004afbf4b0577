#include <gtest/gtest.h>

#include "lab/commands/commands.h"

namespace graspdb::lab {
namespace {

TEST(CommandText, RepeatsTheCommand) {
  CLI::App app("", "graspdb");
  CLI::App* command = app.add_subcommand("eval");
  std::vector<std::string> meshes;
  std::vector<std::string> cases;
  int trials = 24;
  bool list = false;
  command->add_option("meshes", meshes);
  command->add_option("--case", cases)->delimiter(',');
  command->add_option("--trials", trials);
  command->add_flag("--list", list);
  app.parse("eval --list a.ply \"it's b.ply\" --case x,y", /*program_name_included=*/false);
  EXPECT_EQ(CommandText(*command), "graspdb eval a.ply 'it'\\''s b.ply' --case x,y --list");
}

}  // namespace
}  // namespace graspdb::lab
