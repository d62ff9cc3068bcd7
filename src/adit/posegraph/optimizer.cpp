// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/optimizer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/chordal.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/normal_equations.hpp"

namespace adit {
namespace {

constexpr std::size_t kEdgesPerPart = 256;
// A residual this small, in standard deviations squared per edge, is rounding: nothing is left to gain.
constexpr double kRoundingCost = 1e-16;

// Lambda of LM, relative to the diagonal of the normal matrix. It is 0, plain Gauss-Newton, until a step
// disappoints: damping slows the long waves of a chain most, and these are what loops correct.
constexpr double kFirstLambda = 1e-6;
constexpr double kSmallestLambda = 1e-11;
constexpr double kLargestLambda = 1e8;

// The gain ratio: the decrease of the cost over what the quadratic model predicted. A step is taken above
// the first; damping grows below the second (Nocedal and Wright, "Numerical Optimization", algorithm 4.1).
constexpr double kLeastGainRatio = 1e-3;
constexpr double kPoorGainRatio = 0.25;
constexpr double kFirstGrowth = 2.0;  // of lambda; doubles with each poor step in a row
constexpr double kLargestDrop = 0.1;  // of lambda after a good step; Nielsen's third took MIT 8 steps longer

// Steps are solved by conjugate gradients, preconditioned by a factor in floats or of an earlier step.
// Residual left, of the linear system; rounds after which a better factor pays; share of the squared residual
// that a round leaves where those will not do.
constexpr double kForcing = 0.05;
constexpr int kMaxRounds = 3;
constexpr double kHopeless = 0.3;
// How far the best multiple of a solution is from 1 when factor and matrix agree: a float factor is off by
// 1e-7 times the condition number, that of an earlier step near the minimum by about the size of that step.
constexpr double kAgreement = 0.01;
// Floats serve where the smallest pivot of the graph's Laplacian is at least this: in sphere2500, torus3D and
// smallGrid3D it is 0.1 to 0.24, and steps are right to 1e-5; in parking-garage and cubicle it is 0.001, and
// floats fail.
constexpr double kStiff = 0.02;
// In units of the gain that ends the search: what is not worth another round; and the most that the model may
// have missed of the last step for its factor to serve again. What it missed is about what is left to gain:
// with 6 (cubicle) the old factor served, with 13 and more (torus3D, sphere2500) its rounds led nowhere.
constexpr double kLittle = 0.1;
constexpr double kNear = 10.0;

template <class P>
double edge_cost(const typename BasicPoseGraph<P>::Edge& edge, const std::vector<P>& poses) {
  const typename P::Tangent r = between_residual(edge.T_from_to, poses[edge.from], poses[edge.to]);
  return r.dot(edge.information * r);
}

template <class P>
double total_cost(const BasicPoseGraph<P>& graph, const std::vector<P>& poses,
                  const std::vector<double>& weights) {
  return parallel_sum(graph.edges.size(), kEdgesPerPart, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t e = begin; e < end; ++e) {
      if (weights.empty())
        sum += edge_cost<P>(graph.edges[e], poses);
      else if (weights[e] > 0.0)
        sum += weights[e] * edge_cost<P>(graph.edges[e], poses);
    }
    return sum;
  });
}

template <class Matrix>
bool is_indefinite(const Matrix& information) {
  if (!information.allFinite()) return true;
  if ((information - information.transpose()).norm() > 1e-9 * information.norm()) return true;
  if (information.llt().info() == Eigen::Success) return false;
  const auto eigenvalues = symmetric_eigen(information).values;
  return eigenvalues.minCoeff() < -1e-9 * eigenvalues.cwiseAbs().maxCoeff();
}

std::vector<double> damped(const BlockPattern& pattern, std::vector<double> values, std::size_t d,
                           double lambda) {
  for (std::size_t v = 0; v < pattern.size(); ++v) {
    double* block = values.data() + pattern.column_start[v] * d * d;
    for (std::size_t i = 0; i < d; ++i) block[i * d + i] *= 1.0 + lambda;
  }
  return values;
}

template <class P>
std::vector<P> stepped(const std::vector<P>& poses, const GraphStructure& structure,
                       const Eigen::VectorXd& step) {
  std::vector<P> out = poses;
  for (std::size_t v = 0; v < structure.node_of_variable.size(); ++v) {
    P& pose = out[structure.node_of_variable[v]];
    pose = retract(pose, typename P::Tangent(step.segment<P::kDof>(static_cast<Eigen::Index>(v * P::kDof))));
  }
  return out;
}

// The search itself: graph, weights and structure stay, poses and cost move.
template <class P>
class Minimizer {
 public:
  Minimizer(const BasicPoseGraph<P>& graph, const OptimizerConfig& config, const std::vector<double>& weights,
            const GraphStructure& structure, const std::shared_ptr<const BlockSymbolic>& symbolic,
            bool in_floats)
      : graph_(graph),
        config_(config),
        weights_(weights),
        structure_(structure),
        symbolic_(symbolic),
        linearizer_(graph, structure, weights),
        lambda_(config.method == SolveMethod::gauss_newton ? 0.0 : config.initial_damping) {
    if (in_floats)
      quick_.emplace(symbolic, P::kDof);
    else
      exact_.emplace(symbolic, P::kDof);
  }

  void run(Solution<P>& solution) {
    while (solution.status == SolveStatus::max_iterations && solution.iterations < config_.max_iterations) {
      iterate(solution);
    }
  }

 private:
  void iterate(Solution<P>& s) {
    if (!current_) equations_ = &linearizer_.at(s.poses);
    current_ = true;
    ++s.iterations;
    const double enough = config_.relative_tolerance * s.cost_final;
    std::optional<Eigen::VectorXd> step;
    if (kept_ && lambda_ == 0.0) step = step_by_factor(equations_->values, enough, kLittle * enough);
    if (!step) {
      const auto solved = step_by_new_factor();
      if (!solved) return give_up(s, graph_.nodes[structure_.node_of_variable[solved.error()]].key);
      step = *solved;
    }
    if (s.cost_final <= kRoundingCost * static_cast<double>(graph_.edges.size()))
      return converge(s, "the cost is zero");
    const double predicted = predicted_decrease(*step);
    std::vector<P> poses = stepped(s.poses, structure_, *step);
    const double cost = total_cost(graph_, poses, weights_);
    const double decrease = s.cost_final - cost;
    const bool gauss_newton = config_.method == SolveMethod::gauss_newton;
    if (gauss_newton ? std::isfinite(cost) : decrease > kLeastGainRatio * std::max(predicted, 0.0)) {
      kept_ = kept_ && std::abs(decrease - predicted) <= kNear * enough;
      s.poses = std::move(poses);
      s.cost_final = cost;
      current_ = false;
    }
    if (gauss_newton) return judge_gauss_newton(s, decrease, enough);
    judge(s, {predicted, decrease, enough});
  }

  void judge_gauss_newton(Solution<P>& s, double decrease, double enough) {
    if (current_) {
      s.status = SolveStatus::non_finite;
      s.reason = "a Gauss-Newton step made the cost not finite; method lm damps such steps";
    } else if (std::abs(decrease) <= enough) {
      converge(s, kNoLongerFalls);
    }
  }

  // Of one step: what the model predicted, how far the cost fell, and which decrease is too small to go on.
  struct Gain {
    double predicted, decrease, enough;
  };

  // Ends the search, or sets the damping of the next step. A small decrease shows a minimum only where the
  // model holds and nothing is damped: after a small damped step, the undamped one decides.
  void judge(Solution<P>& s, const Gain& gain) {
    const bool is_good = gain.decrease >= kPoorGainRatio * gain.predicted;
    const bool is_small = gain.decrease <= gain.enough;
    // Near the minimum rounding decides the sign of the last decrease; then the prediction counts.
    if (lambda_ == 0.0 && (gain.predicted <= gain.enough || (is_good && is_small)))
      return converge(s, kNoLongerFalls);
    if (!is_good) return small_when_damped_ ? converge(s, kNoLongerFalls) : raise_lambda(s);
    small_when_damped_ = is_small;
    if (is_small)
      lambda_ = 0.0;
    else
      lower_lambda(gain.decrease / gain.predicted);
  }

  // Nielsen's rule: Madsen, Nielsen and Tingleff, equation (2.21).
  void lower_lambda(double gain_ratio) {
    const double x = 2.0 * gain_ratio - 1.0;
    lambda_ *= std::max(kLargestDrop, 1.0 - x * x * x);
    if (lambda_ < kSmallestLambda) lambda_ = 0.0;
    growth_ = kFirstGrowth;
  }

  void raise_lambda(Solution<P>& s) {
    lambda_ = lambda_ == 0.0 ? kFirstLambda : lambda_ * growth_;
    growth_ *= 2.0;
    if (lambda_ > kLargestLambda) converge(s, "no step lowers the cost");
  }

  // The step by a factor of the damped matrix, or the variable that this leaves free. Floats serve until they
  // do not: where the matrix is too badly conditioned for them, doubles take over for good.
  [[nodiscard]] tl::expected<Eigen::VectorXd, std::size_t> step_by_new_factor() {
    std::vector<double> raised;
    if (lambda_ > 0.0) raised = damped(structure_.pattern, equations_->values, P::kDof, lambda_);
    const std::vector<double>& matrix = lambda_ > 0.0 ? raised : equations_->values;
    kept_ = lambda_ == 0.0;
    if (quick_) {
      constexpr double kAnyGain = std::numeric_limits<double>::infinity();
      if (!quick_->factorize(matrix)) {
        if (auto step = step_by_factor(matrix, kAnyGain, 0.0)) return *std::move(step);
      }
      quick_.reset();
      exact_.emplace(symbolic_, P::kDof);
    }
    kept_ = lambda_ == 0.0;
    if (const auto free = exact_->factorize(matrix)) return tl::unexpected(*free);
    return exact_->solve(-equations_->gradient);
  }

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const {
    return quick_ ? quick_->solve(right_side) : exact_->solve(right_side);
  }

  // Solves H x = -g by conjugate gradients, preconditioned by the latest factor: near the minimum H hardly
  // changes, and two or three rounds cost a fraction of a factorization. Nothing when it takes more. One
  // round is enough where factor and matrix agree and the gain is below `little`.
  [[nodiscard]] std::optional<Eigen::VectorXd> step_by_factor(const std::vector<double>& matrix,
                                                              double little, double negligible) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(equations_->gradient.size());
    Eigen::VectorXd r = -equations_->gradient;
    Eigen::VectorXd z = solve(r);
    Eigen::VectorXd p = z;
    double rz = r.dot(z);
    if (rz == 0.0) return x;
    const double enough = std::max(kForcing * kForcing * rz, negligible);
    for (int round = 0; round < kMaxRounds; ++round) {
      const Eigen::VectorXd Hp = times<P::kDof>(structure_.pattern, matrix, p);
      const double length = rz / p.dot(Hp);
      if (!(length > 0.0)) break;
      x += length * p;
      if (round == 0 && rz <= little && std::abs(length - 1.0) <= kAgreement) return x;
      r -= length * Hp;
      z = solve(r);
      const double next = r.dot(z);
      if (next <= enough) return x;
      if (next > kHopeless * rz) break;
      p = z + next / rz * p;
      rz = next;
    }
    kept_ = false;
    return std::nullopt;
  }

  // Of the quadratic model: -2 g.x - x.H x.
  [[nodiscard]] double predicted_decrease(const Eigen::VectorXd& step) const {
    return -2.0 * equations_->gradient.dot(step) -
           step.dot(times<P::kDof>(structure_.pattern, equations_->values, step));
  }

  static constexpr const char* kNoLongerFalls = "the cost no longer falls";
  static void converge(Solution<P>& s, const char* why) {
    s.status = SolveStatus::converged;
    s.reason = why;
  }

  void give_up(Solution<P>& s, std::uint64_t key) {
    s.status = SolveStatus::singular;
    s.reason = format("the edges leave node {} free to move: give them information in every direction", key);
    s.poses = poses_of(graph_);
    s.cost_final = s.cost_initial;
  }

  const BasicPoseGraph<P>& graph_;
  const OptimizerConfig& config_;
  const std::vector<double>& weights_;
  const GraphStructure& structure_;
  std::shared_ptr<const BlockSymbolic> symbolic_;
  // One of the two: exact_ takes over from quick_ where floats do not lead to a step.
  std::optional<BasicBlockCholesky<float>> quick_;
  std::optional<BlockCholesky> exact_;
  bool kept_ = false;  // the latest factor belongs to an H of poses near by
  Linearizer<P> linearizer_;
  const NormalEquations* equations_ = nullptr;
  bool current_ = false;  // equations_ belong to the present poses
  double lambda_;
  double growth_ = kFirstGrowth;    // factor on lambda_ after the next poor step
  bool small_when_damped_ = false;  // the step before was good, damped, and gained too little to go on
};

// Puts the start into `solution`. Returns whether a factor in floats will do.
template <class P>
bool choose_start(const BasicPoseGraph<P>& graph, const OptimizerConfig& config,
                  const std::vector<double>& weights, const GraphStructure& structure,
                  const std::shared_ptr<const BlockSymbolic>& symbolic, Solution<P>& solution) {
  if (config.initialization == SolveStart::given) return false;
  Result<ChordalStart<P>> chordal = chordal_start(graph, weights, structure, symbolic);
  if (!chordal) {
    solution.notes.push_back("no chordal initialization: " + chordal.error().message);
    return false;
  }
  const bool is_stiff = chordal->least_pivot >= kStiff;
  const double cost = total_cost(graph, chordal->poses, weights);
  if (config.initialization == SolveStart::better && !(cost < solution.cost_final)) return is_stiff;
  solution.poses = std::move(chordal->poses);
  solution.cost_final = cost;
  return is_stiff;
}

}  // namespace

std::string_view to_string(SolveMethod method) { return method == SolveMethod::gauss_newton ? "gn" : "lm"; }

std::string_view to_string(SolveStart start) {
  switch (start) {
    case SolveStart::better:
      return "auto";
    case SolveStart::given:
      return "none";
    case SolveStart::chordal:
      return "chordal";
  }
  return "unknown";
}

std::string_view to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::converged:
      return "converged";
    case SolveStatus::max_iterations:
      return "max_iterations";
    case SolveStatus::indefinite_information:
      return "indefinite_information";
    case SolveStatus::singular:
      return "singular";
    case SolveStatus::non_finite:
      return "non_finite";
  }
  return "unknown";
}

template <class P>
std::vector<double> edge_costs(const BasicPoseGraph<P>& graph, const std::vector<P>& poses) {
  ADIT_CHECK(poses.size() == graph.nodes.size(), "one pose per node");
  std::vector<double> costs(graph.edges.size());
  parallel_for_each(
      costs.size(), [&](std::size_t e) { costs[e] = edge_cost<P>(graph.edges[e], poses); }, kEdgesPerPart);
  return costs;
}

template <class P>
std::vector<std::size_t> indefinite_edges(const BasicPoseGraph<P>& graph, std::size_t first) {
  const std::size_t count = graph.edges.size() - std::min(first, graph.edges.size());
  std::vector<char> is_bad(count);
  parallel_for(count, kEdgesPerPart, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& information = graph.edges[first + i].information;
      // Most graphs repeat one matrix over and over.
      const bool repeated = i > begin && information == graph.edges[first + i - 1].information;
      is_bad[i] = repeated ? is_bad[i - 1] : static_cast<char>(is_indefinite(information));
    }
  });
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_bad[i] != 0) out.push_back(first + i);
  }
  return out;
}

template <class P>
Solution<P> optimize(const BasicPoseGraph<P>& graph, const OptimizerConfig& config,
                     const std::vector<double>& edge_weights) {
  graph.check();
  ADIT_CHECK(edge_weights.empty() || edge_weights.size() == graph.edges.size(),
             "one weight per edge, or none");
  Solution<P> solution;
  solution.poses = poses_of(graph);
  solution.edge_weights = edge_weights.empty() ? std::vector<double>(graph.edges.size(), 1.0) : edge_weights;
  solution.cost_initial = solution.cost_final = total_cost(graph, solution.poses, edge_weights);
  if (const auto bad = indefinite_edges(graph); !bad.empty()) {
    const auto& edge = graph.edges[bad.front()];
    solution.status = SolveStatus::indefinite_information;
    solution.reason =
        format("{} of {} information matrices are indefinite, the first of edge {} -> {}", bad.size(),
               graph.edges.size(), graph.nodes[edge.from].key, graph.nodes[edge.to].key);
    return solution;
  }
  if (!std::isfinite(solution.cost_initial)) {
    solution.status = SolveStatus::non_finite;
    solution.reason = "the cost of the start is not a finite number";
    return solution;
  }
  const Components components = connected_components(graph, edge_weights);
  if (components.anchors.size() > 1) {
    solution.notes.push_back(
        format("{} parts that no edge links, each solved with its own anchor", components.anchors.size()));
  }
  solution.status = SolveStatus::max_iterations;
  solution.reason = format("stopped after {} iterations", config.max_iterations);
  const GraphStructure structure = structure_of(graph, components, edge_weights);
  const auto symbolic = analyze(structure.pattern);
  const bool in_floats = choose_start(graph, config, edge_weights, structure, symbolic, solution);
  Minimizer<P>(graph, config, edge_weights, structure, symbolic, in_floats).run(solution);
  return solution;
}

template std::vector<double> edge_costs(const PoseGraph&, const std::vector<Pose>&);
template std::vector<double> edge_costs(const PoseGraph2&, const std::vector<Pose2>&);
template std::vector<std::size_t> indefinite_edges(const PoseGraph&, std::size_t);
template std::vector<std::size_t> indefinite_edges(const PoseGraph2&, std::size_t);
template Solution<Pose> optimize(const PoseGraph&, const OptimizerConfig&, const std::vector<double>&);
template Solution<Pose2> optimize(const PoseGraph2&, const OptimizerConfig&, const std::vector<double>&);

}  // namespace adit
