// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "harness/child_process.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace adit::bench {
namespace {

cpu_set_t allowed_processors() {
  cpu_set_t all;
  CPU_ZERO(&all);
  if (sched_getaffinity(0, sizeof all, &all) != 0)
    throw std::runtime_error("the processors of this process are unknown: " +
                             std::string(std::strerror(errno)));
  return all;
}

/// The first `count` of `all`; all of them for 0.
cpu_set_t first_of(const cpu_set_t& all, int count) {
  if (count <= 0) return all;
  cpu_set_t first;
  CPU_ZERO(&first);
  for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&first) < count; ++cpu) {
    if (CPU_ISSET(cpu, &all)) CPU_SET(cpu, &first);
  }
  return first;
}

}  // namespace

int num_processors() {
  const cpu_set_t all = allowed_processors();
  return CPU_COUNT(&all);
}

ChildProcess::ChildProcess(const Launch& launch) {
  std::array<int, 2> down{};
  std::array<int, 2> up{};
  // Closed on exec: a later child must not hold an earlier one's pipe open, which would never see its end.
  if (pipe2(down.data(), O_CLOEXEC) != 0 || pipe2(up.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("no pipe: " + std::string(std::strerror(errno)));
  std::vector<char*> arguments;
  for (const std::string& word : launch.command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const cpu_set_t processors = first_of(allowed_processors(), launch.num_processors);
  signal(SIGPIPE, SIG_IGN);  // a child that died is seen by its missing answer
  pid_ = fork();
  if (pid_ == 0) {
    dup2(down[0], STDIN_FILENO);
    dup2(up[1], STDOUT_FILENO);
    if (sched_setaffinity(0, sizeof processors, &processors) != 0) _exit(126);
    for (const auto& [name, value] : launch.environment) setenv(name.c_str(), value.c_str(), 1);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  close(down[0]);
  close(up[1]);
  if (pid_ < 0) throw std::runtime_error("no process for " + launch.command.front());
  to_ = fdopen(down[1], "w");
  from_ = fdopen(up[0], "r");
}

ChildProcess::~ChildProcess() {
  std::fclose(to_);
  std::fclose(from_);
  waitpid(pid_, nullptr, 0);
}

void ChildProcess::write_line(const std::string& line) {
  std::fputs((line + "\n").c_str(), to_);
  std::fflush(to_);
}

std::optional<std::string> ChildProcess::read_line() {
  std::string line;
  for (int c = std::fgetc(from_); c != EOF; c = std::fgetc(from_)) {
    if (c == '\n') return line;
    line += static_cast<char>(c);
  }
  return std::nullopt;
}

double ChildProcess::peak_mb() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0.0;
}

}  // namespace adit::bench
