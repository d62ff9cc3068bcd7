// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How long work tells its caller where it stands, and how the caller stops it (decision 0022).
///
/// A caller that wants to know puts an observer in scope; whatever runs inside the scope reports to it and
/// polls it, parallel loops and phases within phases included. Two robots in one process can each have an
/// observer of their own. Without a scope nothing is reported and nothing can be cancelled.
///
///     TerminalProgress bar;                       // any ProgressObserver
///     const ObserverScope scope(bar);
///     const Phase phase("reading", files.size()); // begins; ends with the scope of `phase`
///     for (const auto& file : files) { read(file); phase.advance(); }
///
/// An observer changes no result: the same input gives the same bytes with any observer, or it is cancelled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace adit {

/// Names a phase to the observer that gave the id out; 0 names none.
using PhaseId = std::uint64_t;

/// Is told of phases and asked whether to go on. All members may be called from any thread, several at a
/// time.
class ProgressObserver {
 public:
  ProgressObserver() = default;
  ProgressObserver(const ProgressObserver&) = delete;
  ProgressObserver& operator=(const ProgressObserver&) = delete;
  virtual ~ProgressObserver() = default;

  /// A phase of `total` steps begins, 0 if that is unknown; `parent` is the phase inside which it runs, or 0.
  /// The steps of a phase should take about equally long: the time left is estimated from them.
  /// @returns an id other than 0 that no phase still running has.
  virtual PhaseId begin(std::string_view name, std::size_t total, PhaseId parent) = 0;
  /// So many more steps of a phase that `begin` named are done.
  virtual void advance(PhaseId phase, std::size_t steps) = 0;
  /// The phase is over, be it done or given up. Called once for every `begin`.
  virtual void end(PhaseId phase) noexcept = 0;

  /// Whether the work is to stop. Polled often: an atomic load, not more.
  [[nodiscard]] virtual bool cancelled() const noexcept = 0;
};

/// Thrown where work finds that its observer wants it to stop. It is not an error, so it is not a
/// std::exception: code that reports failures and goes on lets it pass. Destructors remove partial output on
/// its way.
struct Cancelled {};

/// Ends the work by throwing `Cancelled` if the observer in scope wants that. `parallel_for` polls before
/// each part, and `Phase::advance` does; a serial loop of more than about a tenth of a second polls by
/// itself.
void throw_if_cancelled();

/// What a thread reports to: an observer and the phase it works for. Copied into the threads of parallel
/// loops.
struct ProgressContext {
  ProgressObserver* observer = nullptr;  ///< Outlives the context. Null: nobody is told.
  PhaseId phase = 0;                     ///< New phases begin inside of it; 0: they are inside of none.
};
/// That of the calling thread; without an observer where none is in scope.
[[nodiscard]] ProgressContext progress_context();

/// Makes `context` this thread's own until the end of the scope.
class ProgressScope {
 public:
  /// The context that held before comes back at the end.
  explicit ProgressScope(const ProgressContext& context);
  ~ProgressScope();
  ProgressScope(const ProgressScope&) = delete;
  ProgressScope& operator=(const ProgressScope&) = delete;

 private:
  ProgressContext before_;
};

/// From here to the end of the scope, this thread and the parallel loops that it starts report to `observer`.
class ObserverScope : public ProgressScope {
 public:
  /// `observer` must outlive the scope. Phases inside of it are inside of no other.
  explicit ObserverScope(ProgressObserver& observer) : ProgressScope({&observer, 0}) {}
};

/// A phase of the work: begins with the object, ends with it. Nothing happens where no observer is in scope.
class Phase {
 public:
  /// Begins at the observer in scope, inside the phase in scope.
  /// @param name what is done, for people.
  /// @param total number of steps; 0 if unknown.
  explicit Phase(std::string_view name, std::size_t total = 0);
  ~Phase();
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

  /// So many more steps are done. From any thread. Throws `Cancelled` as `throw_if_cancelled` does.
  void advance(std::size_t steps = 1) const;

 private:
  ProgressContext own_;
  ProgressScope scope_;
};

}  // namespace adit
