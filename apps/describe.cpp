// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

std::string replaced(const std::string& text, const std::vector<std::pair<char, const char*>>& characters) {
  std::string out;
  for (const char c : text) {
    const auto found = std::ranges::find(characters, c, &std::pair<char, const char*>::first);
    out += found == characters.end() ? std::string(1, c) : found->second;
  }
  return out;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// ---- manual page -----------------------------------------------------------------------------------------

/// For troff: no escapes, hyphens that can be copied, and no request at the begin of a line.
std::string roff(const std::string& text) { return "\\&" + replaced(text, {{'\\', "\\e"}, {'-', "\\-"}}); }

std::string option_entry(const OptionHelp& option) {
  std::string term = option.name.empty() ? "" : ".B " + roff(option.name);
  if (!option.value.empty()) {
    const std::string value = "\\fI" + roff(option.value) + "\\fR";
    term = option.name.empty() ? value : term + " " + value;
  }
  const std::string choices = option.choices.empty() ? "" : ". One of: " + joined(option.choices);
  return ".TP\n" + term + "\n" + roff(option.help + choices) + "\n";
}

std::string command_section(const CommandHelp& command) {
  std::string text = ".SS \"adit " + roff(command.name) + "\"\n" + roff(command.description) + ".\n";
  for (const OptionHelp& option : command.options)
    if (option.name != "--help") text += option_entry(option);
  if (!command.footer.empty()) text += ".PP\n" + roff(command.footer) + "\n";
  return text;
}

std::string man_page(const std::vector<CommandHelp>& all) {
  const CommandHelp& program = all.front();
  std::string text = format(
      ".TH ADIT 1 \"\" \"adit {}\" \"User Commands\"\n.SH NAME\nadit \\- {}\n.SH SYNOPSIS\n.B adit\n"
      "\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH OPTIONS\nEvery command takes these.\n",
      version(), roff(program.description));
  for (const OptionHelp& option : program.options) text += option_entry(option);
  text += ".SH COMMANDS\n";
  for (std::size_t i = 1; i < all.size(); ++i) text += command_section(all[i]);
  text +=
      ".SH EXIT STATUS\n0 done, 1 data or run\\-time error, 2 wrong usage, 130 interrupted by Ctrl\\-C "
      "(143 by SIGTERM).\n";
  return text;
}

// ---- completion ------------------------------------------------------------------------------------------

std::vector<std::string> option_names(const CommandHelp& command) {
  std::vector<std::string> names;
  for (const OptionHelp& option : command.options)
    if (!option.name.empty()) names.push_back(option.name);
  return names;
}

/// Lines "COMMAND WORD) values ;;" of what takes few values: after options, or the command itself.
std::string choice_cases(const CommandHelp& command) {
  std::string cases;
  for (const OptionHelp& option : command.options) {
    if (option.choices.empty()) continue;
    cases += format("    {} {}') words='{}' ;;\n", command.name.empty() ? "*'" : "'" + command.name,
                    option.name.empty() ? command.name : option.name, joined(option.choices));
  }
  return cases;
}

std::string bash_completion(const std::vector<CommandHelp>& all) {
  std::string commands, options, choices;
  for (const CommandHelp& command : all) {
    choices += choice_cases(command);
    if (command.name.empty()) continue;
    commands += (commands.empty() ? "" : " ") + command.name;
    options += format("    {}) words='{}' ;;\n", command.name, joined(option_names(command)));
  }
  return format(R"(# bash completion for adit, made by 'adit describe bash'
_adit() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command= words= i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case " {0} " in *" ${{COMP_WORDS[i]}} "*) command=${{COMP_WORDS[i]}}; break ;; esac
  done
  [[ $current == -* ]] || case "$command $previous" in
{2}  esac
  if [[ -z $words && $current == -* ]]; then
    case $command in
{1}    esac
    words+=' {3}'
  elif [[ -z $words && -z $command ]]; then
    words='{0}'
  fi
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  else
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}}
complete -F _adit adit
)",
                commands, options, choices, joined(option_names(all.front())));
}

std::string zsh_text(const std::string& text) {
  return replaced(text, {{'\'', "'\\''"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}});
}

/// What _arguments is to offer for the command's arguments that are no options.
std::string zsh_arguments(const CommandHelp& command) {
  const auto chosen = std::ranges::find_if(command.options, [](const OptionHelp& option) {
    return option.name.empty() && !option.choices.empty();
  });
  return chosen == command.options.end() ? "'*:file:_files'"
                                         : "'*:" + chosen->value + ":(" + joined(chosen->choices) + ")'";
}

/// Arguments of _arguments, one a line, without a command's own --help: the program has one.
std::string zsh_options(const CommandHelp& command) {
  std::string text;
  for (const OptionHelp& option : command.options) {
    if (option.name.empty() || (option.name == "--help" && !command.name.empty())) continue;
    text += format(" \\\n      '*{}[{}]", option.name, zsh_text(option.help));
    if (!option.choices.empty())
      text += ":value:(" + joined(option.choices) + ")";
    else if (!option.value.empty())
      text += ":value:_files";
    text += "'";
  }
  return text;
}

std::string zsh_completion(const std::vector<CommandHelp>& all) {
  std::string commands, cases;
  for (const CommandHelp& command : all) {
    if (command.name.empty()) continue;
    commands += format("    '{}:{}'\n", command.name, zsh_text(command.description));
    cases += format("    {}) _arguments{}{} \\\n      {} ;;\n", command.name, zsh_options(command),
                    zsh_options(all.front()), zsh_arguments(command));
  }
  return format(R"(#compdef adit
# zsh completion for adit, made by 'adit describe zsh'
_adit() {{
  local -a commands=(
{0}  )
  local state
  _arguments -C '1:command:->command' '*::argument:->argument'{2}
  case $state in
  command) _describe command commands ;;
  argument)
    case $words[1] in
{1}    esac ;;
  esac
}}
_adit "$@"
)",
                commands, cases, zsh_options(all.front()));
}

Result<> describe(const Program& program, const std::string& form) {
  const std::vector<CommandHelp> all = program.help();
  const std::string text = form == "man"    ? man_page(all)
                           : form == "bash" ? bash_completion(all)
                                            : zsh_completion(all);
  std::fputs(text.c_str(), stdout);
  return {};
}

}  // namespace

void add_describe(Program& program) {
  const auto form = std::make_shared<std::string>();
  const Command command =
      program.add_command("describe", "Print the manual page, or what a shell needs to complete commands",
                          [&program, form](const Common&) { return describe(program, *form); });
  command.add_option("form", *form, "man, bash or zsh").required().one_of({"man", "bash", "zsh"});
  command.footer("Packages install all three. Otherwise: source <(adit describe bash).");
}

}  // namespace adit::app
