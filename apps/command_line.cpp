// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <exception>

#include "adit/core/parallel.hpp"
#include "adit/core/version.hpp"
#include "adit/io/text.hpp"
#include "run_command.hpp"

namespace adit::app {

Option Option::required() const { return Option(*option_->required()); }
Option Option::one_of(const std::vector<std::string>& values) const {
  return Option(*option_->check(CLI::IsMember(values)));
}
Option Option::in_range(int least, int most) const {
  return Option(*option_->check(CLI::Range(least, most)));
}
Option Option::separated_by_commas() const { return Option(*option_->delimiter(',')); }
Option Option::default_shown() const { return Option(*option_->capture_default_str()); }
Option Option::check(const std::function<std::string(const std::string&)>& fault) const {
  return Option(*option_->check(fault));
}

Option Command::add_option(const std::string& name, std::string& value, const std::string& help) const {
  return Option(*app_->add_option(name, value, help));
}
Option Command::add_option(const std::string& name, int& value, const std::string& help) const {
  return Option(*app_->add_option(name, value, help));
}
Option Command::add_option(const std::string& name, std::vector<std::string>& values,
                           const std::string& help) const {
  return Option(*app_->add_option(name, values, help));
}
Option Command::add_option(const std::string& name, std::vector<int>& values, const std::string& help) const {
  return Option(*app_->add_option(name, values, help));
}
Option Command::add_option(const std::string& name, std::optional<std::uint64_t>& value,
                           const std::string& help) const {
  return Option(*app_->add_option(name, value, help));
}
Option Command::add_flag(const std::string& name, bool& value, const std::string& help) const {
  return Option(*app_->add_flag(name, value, help));
}
void Command::exclude(const std::string& name, const std::vector<std::string>& others) const {
  for (const std::string& other : others) app_->get_option(name)->excludes(app_->get_option(other));
}
void Command::footer(const std::string& text) const { app_->footer(text); }

namespace {
constexpr int kMostThreads = 1024;  // more are a typing error
}  // namespace

Program::Program()
    : cli_(std::make_unique<CLI::App>("Multi-robot LiDAR SLAM for tunnels, mines and caves", "adit")) {
  cli_->require_subcommand(1);
  cli_->failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("adit: ") + error.what() +
           " ('adit --help' lists the commands, 'adit COMMAND --help' its options)\n";
  });
  cli_->set_version_flag("--version", std::string(version()));
  cli_->add_flag("--json", common_.json, "Print only the result, as JSON, on stdout");
  cli_->add_option("--threads", common_.threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, kMostThreads));
  std::vector<std::string> profiles;
  for (const Profile profile : kProfiles) profiles.emplace_back(to_string(profile));
  cli_->add_option("--profile", profile_,
                   "Configuration to start from: default, paper (its pipeline and odometry), lidar-only "
                   "(KISS-ICP, for robots without wheel odometry)")
      ->check(CLI::IsMember(profiles))
      ->capture_default_str();
  cli_->add_option("--config", common_.config_file,
                   "TOML file with configuration fields, as 'adit config' prints them")
      ->check(CLI::ExistingFile);
  cli_->add_option("--set", common_.sets, "Set one configuration field: key=value (repeatable)")
      ->allow_extra_args(false);
  cli_->fallthrough();
}

Program::~Program() = default;

Command Program::add_command(const std::string& name, const std::string& description, Body body) {
  CLI::App* command = cli_->add_subcommand(name, description);
  command->fallthrough();
  command->callback([this, name, command, body = std::move(body)] {
    common_.command = command_of(*command);
    common_.profile = *std::ranges::find(kProfiles, profile_, [](Profile p) { return to_string(p); });
    if (common_.threads > 0) set_num_threads(common_.threads);
    exit_code_ = run_command(name, [&]() -> Result<> {
      // Also for commands that need no configuration: a wrong setting is never ignored.
      if (const Result<RunConfig> config = configured(common_); !config)
        return tl::unexpected(config.error());
      return body(common_);
    });
  });
  return Command(*command);
}

namespace {

// Options for where output goes and how it is computed change no result.
bool changes_results(const std::string& option) {
  constexpr std::array kNeutral{"--out", "--page", "--threads", "--json", "--help", "--rerun"};
  return std::ranges::find(kNeutral, option) == kNeutral.end();
}

/// The option as it was given, with a blank in front; "" where it was not.
std::string text_of(const CLI::Option& option) {
  if (option.count() == 0 || !changes_results(option.get_name())) return "";
  const std::string name = option.get_positional() ? "" : " " + option.get_name();
  if (option.get_expected_max() == 0) return name;  // a flag
  const char delimiter = option.get_delimiter();
  std::string text;
  for (const std::string& value : option.results()) {
    const bool joins = delimiter != '\0' && !text.empty();
    text += joins ? delimiter + value : name + " " + shell_quoted(value);
  }
  return text;
}

}  // namespace

namespace {

/// Of a type such as "TEXT:{a,b}", as CLI11 writes it.
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t begin = type.find(":{");
  if (begin == std::string::npos || type.back() != '}') return {};
  return CLI::detail::split(type.substr(begin + 2, type.size() - begin - 3), ',');
}

OptionHelp help_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  OptionHelp help{"", "", choices_of(type), option.get_description()};
  if (option.get_positional()) {
    help.value = option.get_name(true);
  } else {
    help.name = option.get_lnames().empty() ? option.get_name() : "--" + option.get_lnames().front();
    if (option.get_expected_max() != 0) help.value = type.substr(0, type.find(':'));
  }
  return help;
}

CommandHelp help_of(const CLI::App& app, const std::string& name) {
  CommandHelp help{name, app.get_description(), app.get_footer(), {}};
  for (const CLI::Option* option : app.get_options()) help.options.push_back(help_of(*option));
  return help;
}

}  // namespace

std::vector<CommandHelp> Program::help() const {
  std::vector<CommandHelp> all{help_of(*cli_, "")};
  for (const CLI::App* command : cli_->get_subcommands({}))
    all.push_back(help_of(*command, command->get_name()));
  return all;
}

std::string Program::command_of(const CLI::App& command) const {
  std::string text = "adit " + command.get_name();
  for (const CLI::Option* option : command.get_options()) text += text_of(*option);
  for (const CLI::Option* option : cli_->get_options()) text += text_of(*option);
  return text;
}

namespace {

/// The first word that is neither an option nor the value of one; "" where there is none.
std::string first_word(const CLI::App& program, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with('-')) return word;
    const CLI::Option* option = program.get_option_no_throw(word);
    if (option != nullptr && option->get_expected_max() > 0) ++i;
  }
  return "";
}

}  // namespace

// CLI11 would only say that a command is missing.
void Program::check_command(const std::string& name) const {
  if (name.empty()) return;
  std::vector<std::string> known;
  for (const CLI::App* command : cli_->get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::string nearest = nearest_key(known, name);
  usage_error("unknown command '" + name + "'" +
              (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

// CLI11 names what was not expected, but not what may have been meant.
void Program::parse(int argc, char** argv) const {
  try {
    cli_->parse(argc, argv);
  } catch (const CLI::ExtrasError&) {
    std::vector<std::string> known;
    const auto add_options = [&](const CLI::App& app) {
      for (const CLI::Option* option : app.get_options()) known.push_back(option->get_name());
    };
    add_options(*cli_->get_subcommand(first_word(*cli_, argc, argv)));
    add_options(*cli_);
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      const std::string name = word.substr(0, word.find('='));
      if (!name.starts_with("--") || std::ranges::find(known, name) != known.end()) continue;
      const std::string nearest = nearest_key(known, name);
      usage_error("unknown option '" + name + "'" +
                  (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
    }
    throw;
  }
}

int Program::run(int argc, char** argv) {
  try {
    check_command(first_word(*cli_, argc, argv));
    parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli_->exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "adit: internal error: %s\n", error.what());
    return 1;
  }
  return exit_code_;
}

void usage_error(const std::string& message) { throw CLI::ValidationError(message); }

}  // namespace adit::app
