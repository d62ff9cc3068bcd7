// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The manual page and the completions say what the program says.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "support/files.hpp"
#include "support/program.hpp"

namespace adit::test {
namespace {

std::set<std::string> commands_of_help() {
  const std::string help = run_adit("--help").out;
  const std::string list = help.substr(help.find("Subcommands:\n"));
  const std::regex line("\n  ([a-z][a-z-]*) ");
  return {std::sregex_token_iterator(list.begin(), list.end(), line, 1), std::sregex_token_iterator()};
}

/// What bash offers where the line ends in the last of `words`.
std::set<std::string> completed(const std::string& words) {
  const TemporaryFolder folder;
  const std::string script = folder / "completion.bash";
  put_file(script,
           run_adit("describe bash").out + "\nCOMP_WORDS=(adit " + words +
               ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_adit\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const std::string out = script + ".out";
  EXPECT_EQ(std::system(("bash " + script + " >" + out).c_str()), 0);
  std::istringstream lines(get_file(out));
  std::set<std::string> offers;
  for (std::string line; std::getline(lines, line);) offers.insert(line);
  return offers;
}

TEST(Describe, BashOffersTheCommandsOfTheHelp) {
  EXPECT_EQ(completed("''"), commands_of_help());
  EXPECT_EQ(completed("sol"), std::set<std::string>{"solve"});
}

TEST(Describe, BashOffersOptionsAndTheirValues) {
  EXPECT_EQ(completed("solve --gn"), std::set<std::string>{"--gnc"});
  EXPECT_EQ(completed("solve --thr"), std::set<std::string>{"--threads"});
  EXPECT_EQ(completed("odometry --method k"), (std::set<std::string>{"kiss-icp", "kinematic-icp"}));
  EXPECT_EQ(completed("slam --profile p"), std::set<std::string>{"paper"});
  EXPECT_EQ(completed("slam --keyframes ad"), std::set<std::string>{"adaptive"});
  EXPECT_EQ(completed("describe ''"), (std::set<std::string>{"man", "bash", "zsh"}));
  EXPECT_EQ(completed("describe --thr"), std::set<std::string>{"--threads"});
  EXPECT_TRUE(completed("config --gn").contains(""));
}

TEST(Describe, TheManualPageHasEveryCommandAndOption) {
  const std::string page = run_adit("describe man").out;
  for (const std::string& command : commands_of_help()) {
    const std::string escaped = std::regex_replace(command, std::regex("-"), "\\-");
    EXPECT_NE(page.find(".SS \"adit \\&" + escaped + "\"\n"), std::string::npos) << command;
  }
  EXPECT_NE(page.find(".B \\&\\-\\-gnc\n"), std::string::npos);
  // No line begins with a request that the page did not mean.
  EXPECT_FALSE(std::regex_search(page, std::regex("\n['.](?!TH|SH|SS|TP|PP|B )")));
}

TEST(Describe, ZshGetsEveryCommandAndItsChoices) {
  const std::string text = run_adit("describe zsh").out;
  EXPECT_TRUE(text.starts_with("#compdef adit\n"));
  for (const std::string& command : commands_of_help())
    EXPECT_NE(text.find("\n    " + command + ") _arguments"), std::string::npos) << command;
  EXPECT_NE(text.find("*--keyframes[Keyframe policy (default\\: adaptive)]:value:(adaptive all "),
            std::string::npos);
  EXPECT_NE(text.find("'*:form:(man bash zsh)'"), std::string::npos);
}

TEST(Describe, RulingsSayThatSlamTakesThemWithASession) {
  const std::string text = run_adit("describe zsh").out;
  const std::size_t slam = text.find("\n    slam) _arguments");
  const std::size_t merge = text.find("\n    merge) _arguments");
  ASSERT_TRUE(slam != std::string::npos && merge != std::string::npos);
  const auto of_command = [&](std::size_t begin) {
    return text.substr(begin, text.find(";;\n", begin) - begin);
  };
  for (const std::string option : {"--veto", "--confirm", "--withdraw"})
    EXPECT_TRUE(std::regex_search(of_command(slam),
                                  std::regex(option + R"(\[[^\n]*\(repeatable; needs --session\)\])")))
        << option;
  EXPECT_EQ(of_command(merge).find("needs --session"), std::string::npos);
}

TEST(Describe, AnotherFormIsWrongUsage) { expect_refused("describe fish", 2, "fish"); }

}  // namespace
}  // namespace adit::test
