// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The program `adit` as a process of its own: signals at a chosen moment, what is left behind, a terminal.
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "support/files.hpp"

namespace adit::test {

/// How a process ended.
struct Ended {
  int exit_code = -1;               ///< -1 when a signal ended it.
  double cpu_s = 0.0;               ///< Processor time of all its threads.
  double cpu_after_signal_s = 0.0;  ///< Of that, after the signal was sent; 0 if none was.
};

class Process {
 public:
  /// Starts `adit` with these arguments; stdout and stderr go to the file `log`.
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& log) : pid_(fork()) {
    if (pid_ != 0) return;
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execute(arguments);
  }

  /// Waits until the process has used so much processor time, which does not depend on how busy the machine
  /// is; then sends the signal and waits for the end. Without effect on a process that ends before.
  [[nodiscard]] Ended signal_after(double cpu_s, int signal) const {
    siginfo_t info{};
    while (!has_ended(info) && used_s() < cpu_s) usleep(2000);
    const double before = used_s();
    kill(pid_, signal);
    Ended ended = wait();
    ended.cpu_after_signal_s = ended.cpu_s - before;
    return ended;
  }

  [[nodiscard]] Ended wait() const {
    int status = 0;
    rusage usage{};
    wait4(pid_, &status, 0, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds(usage.ru_utime) + seconds(usage.ru_stime)};
  }

  /// Replaces this process by the program; for after fork.
  [[noreturn]] static void execute(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "adit");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(ADIT_PROGRAM, argv.data());
    _exit(127);
  }

 private:
  [[nodiscard]] bool has_ended(siginfo_t& info) const {
    info.si_pid = 0;
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid != 0;
  }

  // Fields 14 and 15 of /proc/PID/stat, counted after the name in brackets.
  [[nodiscard]] double used_s() const {
    std::string text = get_file("/proc/" + std::to_string(pid_) + "/stat");
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) return 0.0;
    std::istringstream fields(text.substr(name_end + 1));
    std::string skipped;
    for (int i = 0; i < 11; ++i) fields >> skipped;
    double user = 0.0;
    double system = 0.0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }

  pid_t pid_;
};

/// All that `adit` writes to a terminal of 120 columns until it ends.
inline std::string output_on_terminal(const std::vector<std::string>& arguments) {
  winsize size{40, 120, 0, 0};
  int terminal = -1;
  const pid_t pid = forkpty(&terminal, nullptr, nullptr, &size);
  if (pid == 0) Process::execute(arguments);
  std::string output;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; (n = read(terminal, block.data(), block.size())) > 0;)
    output.append(block.data(), static_cast<std::size_t>(n));
  close(terminal);
  waitpid(pid, nullptr, 0);
  return output;
}

/// Path below `folder` -> bytes of all files in it.
inline std::map<std::string, std::string> tree_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    files[name] = entry.is_regular_file() ? get_file(entry.path()) : "";
  }
  return files;
}

}  // namespace adit::test
