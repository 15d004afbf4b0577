#include "program/settings_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/files/temporary_folder.h"

namespace graspdb {
namespace {

// An environment variable for the duration of a test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    setenv(name, value.c_str(), 1);
  }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

// The exit status of `program wait --seconds VALUE`, nothing if it is accepted.
std::optional<int> ExitOfWait(std::string value) {
  CLI::App app;
  double seconds = 1;
  app.add_subcommand("wait")->add_option("--seconds", seconds)->check(CLI::Range(0.0, 10.0));
  std::string program = "program";
  std::string command = "wait";
  std::string flag = "--seconds";
  std::array<char*, 4> words = {program.data(), command.data(), flag.data(), value.data()};
  return ParseArguments(app, static_cast<int>(words.size()), words.data());
}

TEST(ParseArguments, ARangeHasNumbersOnly) {
  EXPECT_EQ(ExitOfWait("2.5"), std::nullopt);
  EXPECT_EQ(ExitOfWait("11"), 2);
  EXPECT_EQ(ExitOfWait("nan"), 2);
  EXPECT_EQ(ExitOfWait("NaN"), 2);
}

// The same of `program [--out TEXT] [--json] [wait [--name TEXT] [FILE]]` with these words.
std::optional<int> ExitOf(std::vector<std::string> words) {
  CLI::App app;
  std::string out;
  std::string name;
  std::string file;
  bool json = false;
  app.add_option("--out", out);
  app.add_flag("--json", json);
  CLI::App* wait = app.add_subcommand("wait")->fallthrough();
  wait->add_option("--name", name);
  wait->add_option("FILE", file);
  AddSettingsFile(app);
  words.insert(words.begin(), "program");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  return ParseArguments(app, static_cast<int>(argv.size()), argv.data());
}

TEST(ParseArguments, AFlagIsNoValueOfTheOneBefore) {
  EXPECT_EQ(ExitOf({"--out", "--json"}), 2);
  EXPECT_EQ(ExitOf({"--out", "--help"}), 2);
  EXPECT_EQ(ExitOf({"wait", "--name", "--json"}), 2);
  EXPECT_EQ(ExitOf({"wait", "--name", "--out=a"}), 2);
  EXPECT_EQ(ExitOf({"wait", "--out", "--name", "a"}), 2);
  EXPECT_EQ(ExitOf({"--out", "-5", "--json"}), std::nullopt);
  EXPECT_EQ(ExitOf({"--out", "--other", "--json"}), std::nullopt);
  EXPECT_EQ(ExitOf({"wait", "--name", "a", "--", "--json"}), std::nullopt);
}

TEST(ParseArguments, AFlagWithoutItsValueDoesNotTakeTheNextWord) {
  EXPECT_EQ(ExitOf({"--out=", "wait"}), 2);
  EXPECT_EQ(ExitOf({"wait", "--name=", "--json"}), 2);
  EXPECT_EQ(ExitOf({"--out", "", "wait"}), std::nullopt);
  EXPECT_EQ(ExitOf({"--out=a=", "wait"}), std::nullopt);
  EXPECT_EQ(ExitOf({"wait", "--", "--name="}), std::nullopt);
}

TEST(ParseArguments, WhatOnlyAShellExpandsIsNoValue) {
  EXPECT_EQ(ExitOf({"--out=~/base"}), 2);
  EXPECT_EQ(ExitOf({"--out", "~"}), 2);
  EXPECT_EQ(ExitOf({"wait", "~/file"}), 2);
  EXPECT_EQ(ExitOf({"--out", "base~/x", "wait", "~file"}), std::nullopt);
  const Variable out("GRASPDB_OUT", "~/base");
  EXPECT_EQ(ExitOf({"--json"}), 2);
}

TEST(ParseArguments, AVariableHasNoQuotesAroundItsValue) {
  for (const char* value : {"\"base\"", "'base'", "\"\""}) {
    const Variable out("GRASPDB_OUT", value);
    EXPECT_EQ(ExitOf({"--json"}), 2) << value;
    EXPECT_EQ(ExitOf({"--out", "base"}), std::nullopt) << "the flag overrides " << value;
  }
  for (const char* value : {"a \"base\"", "\"", "'base\""}) {
    const Variable out("GRASPDB_OUT", value);
    EXPECT_EQ(ExitOf({"--json"}), std::nullopt) << value;
  }
}

class SettingsFileTest : public ::testing::Test {
 protected:
  // The resulting values of --server and `import --split`.
  std::string Parse(const std::string& arguments, std::vector<std::string> other_commands = {}) {
    CLI::App app;
    std::string server = "default";
    std::string split = "default";
    app.add_option("--server", server);
    CLI::App* import = app.add_subcommand("import");
    import->add_option("--split", split);
    AddSettingsFile(app, std::move(other_commands));
    app.parse(arguments);
    return server + " " + split;
  }

  // The first part of the error of a file with this text, without its name; empty if there is none.
  std::string ErrorOf(const std::string& text) {
    const std::string file = folder_.Write("wrong.conf", text).string();
    try {
      Parse("--config " + file + " import");
    } catch (const CLI::ParseError& e) {
      const std::string error = e.what();
      return error.starts_with(file) ? error.substr(file.size(), error.find(';') - file.size())
                                     : error;
    }
    return "";
  }

  const files::TemporaryFolder folder_;
  const std::string file_ =
      folder_.Write("settings.conf", "server=file\n[import]\nsplit=file\n").string();
};

TEST_F(SettingsFileTest, AppliesWithoutOtherSettings) {
  EXPECT_EQ(Parse("import"), "default default");
  EXPECT_EQ(Parse("--config " + file_ + " import"), "file file");
}

TEST_F(SettingsFileTest, IsOverriddenByVariablesAndTheseByFlags) {
  const Variable server("GRASPDB_SERVER", "variable");
  EXPECT_EQ(Parse("--config " + file_ + " import"), "variable file");
  EXPECT_EQ(Parse("--config " + file_ + " --server flag import"), "flag file");
  const Variable split("GRASPDB_SPLIT", "variable");
  EXPECT_EQ(Parse("--config " + file_ + " import"), "variable variable");
}

TEST_F(SettingsFileTest, AnOptionKeepsItsOwnVariable) {
  CLI::App app;
  std::string listen = "default";
  app.add_subcommand("serve")->add_option("--listen", listen)->envname("GRASPDB_OTHER_LISTEN");
  AddSettingsFile(app);
  const std::string file = folder_.Write("own.conf", "[serve]\nlisten=file\n").string();
  const Variable of_flag("GRASPDB_LISTEN", "variable");
  app.parse("--config " + file + " serve");
  EXPECT_EQ(listen, "file");
  const Variable own("GRASPDB_OTHER_LISTEN", "own variable");
  app.parse("--config " + file + " serve");
  EXPECT_EQ(listen, "own variable");
}

TEST_F(SettingsFileTest, CanBeSetByAVariable) {
  const Variable config("GRASPDB_CONFIG", file_);
  EXPECT_EQ(Parse("import"), "file file");
  const std::string other = folder_.Write("other.conf", "server=other\n").string();
  EXPECT_EQ(Parse("--config " + other + " import"), "other default");
}

TEST_F(SettingsFileTest, AByteOrderMarkIsSkipped) {
  const std::string windows =
      folder_.Write("windows.conf", "\xEF\xBB\xBFserver=\"file\"\r\n").string();
  EXPECT_EQ(Parse("--config " + windows + " import"), "file default");
  const std::string empty = folder_.Write("empty.conf", "").string();
  EXPECT_EQ(Parse("--config " + empty + " import"), "default default");
}

TEST_F(SettingsFileTest, MissingFileIsAnError) {
  EXPECT_THROW(Parse("--config /nonexistent/file import"), CLI::ParseError);
  const Variable config("GRASPDB_CONFIG", "/nonexistent/file");
  EXPECT_THROW(Parse("import"), CLI::ParseError);
}

TEST_F(SettingsFileTest, SectionsOfOtherCommandsAreIgnored) {
  const std::string shared =
      folder_.Write("shared.conf", "server=file\n[eval]\ntrials=3\n").string();
  EXPECT_EQ(Parse("--config " + shared + " import", {"eval"}), "file default");
  EXPECT_THROW(Parse("--config " + shared + " import"), CLI::ParseError);
}

TEST_F(SettingsFileTest, UnknownKeyIsAnError) {
  const std::string typo = folder_.Write("typo.conf", "sever=file\n").string();
  EXPECT_THROW(Parse("--config " + typo + " import"), CLI::ParseError);
}

TEST_F(SettingsFileTest, TheErrorOfAnUnknownKeyNamesTheFile) {
  EXPECT_EQ(ErrorOf("sever=file\n"), ": there is no setting sever");
  EXPECT_EQ(ErrorOf("[import]\nspilt=ALL\n"), ": there is no setting import.spilt");
  EXPECT_EQ(ErrorOf("[impot]\nsplit=ALL\n"), ": there is no section [impot]");
}

TEST_F(SettingsFileTest, TheErrorOfAListWithoutItsEndNamesTheLine) {
  EXPECT_EQ(ErrorOf("# comment=[\nserver=[\"a\"\n[import]\nsplit=ALL\n"),
            ", line 2: the list of server has no ] at its end");
  EXPECT_EQ(ErrorOf("[import]\nsplit = [\n"), ", line 2: the list of split has no ] at its end");
  EXPECT_EQ(ErrorOf("server=[\"a#b\"]\n"), ", line 1: the list of server has no ] at its end");
  EXPECT_EQ(ErrorOf("server=[\"a\"] # comment\n\n[import]\nsplit=[\"b\"]\r\n"), "");
}

}  // namespace
}  // namespace graspdb
