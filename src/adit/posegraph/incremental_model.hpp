// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The quadratic model of a pose graph that grows, for `IncrementalOptimizer`. Private to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "adit/posegraph/incremental_cholesky.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// A graph, its present poses, and the model of its cost around them: cost and gradient are exact, the factor
/// of the Hessian has each edge as it was when it was linearized last.
template <class P>
class IncrementalModel {
 public:
  static constexpr int D = P::kDof;                   ///< Rows of a node in the factor.
  using Edge = typename BasicPoseGraph<P>::Edge;      ///< As of the graph.
  using Tangent = typename P::Tangent;                ///< A perturbation of factors.hpp.
  using Step = IncrementalCholesky::PartialSolution;  ///< Perturbations of the nodes, by `variable`.
  /// Of a node in the factor; the first has none.
  static std::size_t variable(std::size_t node) { return node - 1; }

  /// Steps below this many metres and radians are not taken.
  static constexpr double kSmallestStep = 1e-5;

  /// `pose`: T_world_node, where the node stays until a step moves it.
  void add_node(std::uint64_t key, const P& pose);
  /// The edge is out of use. Its nodes must have been added.
  void add_edge(const Edge& edge);
  /// Counts from the next `renew` on.
  void set_use(std::size_t edge, bool is_used);

  /// Everything added so far; node poses as given.
  [[nodiscard]] const BasicPoseGraph<P>& graph() const { return graph_; }
  /// T_world_node at present, one per node.
  [[nodiscard]] const std::vector<P>& poses() const { return poses_; }
  /// As `set_use` left it, even before the next `renew`.
  [[nodiscard]] bool is_used(std::size_t edge) const {
    return term_of_[edge] != kNone && terms_[term_of_[edge]].is_used;
  }
  /// chi2 of an edge in use at the present poses, as of the last `renew`.
  [[nodiscard]] double cost(std::size_t edge) const { return costs_[term_of_[edge]]; }
  /// Of all edges in use.
  [[nodiscard]] double cost() const;
  /// The factor of the Hessian, as of the last `renew` or linearization; without the first node.
  ///@{
  [[nodiscard]] const IncrementalCholesky& cholesky() const { return cholesky_; }
  [[nodiscard]] IncrementalCholesky& cholesky() { return cholesky_; }
  ///@}
  /// T_from_to at the present poses.
  [[nodiscard]] P relative(const Edge& edge) const { return poses_[edge.from].inverse() * poses_[edge.to]; }

  /// Edges whose use has changed since the last `renew`.
  [[nodiscard]] const std::vector<std::size_t>& changed() const { return changed_; }
  /// Brings cost, gradient and factor up to date. This and all below: returns a node that is free to move, or
  /// nothing when all is well. After a failure the next `renew` makes the factor from nothing.
  [[nodiscard]] std::optional<std::size_t> renew();
  /// Whether the last `renew` changed the gradient. An edge without residual does not, such as the odometry
  /// to a new node that starts where it leads.
  [[nodiscard]] bool has_new_gradient() const { return has_new_gradient_; }
  /// Linearizes anew those of the terms that have changed by more than this, radians and share of the length
  /// plus a metre. Adds how many to `num_linearized`.
  [[nodiscard]] std::optional<std::size_t> linearize_changed(const std::vector<std::size_t>& terms,
                                                             double change, std::size_t& num_linearized);
  /// Of every edge that is or was in use.
  [[nodiscard]] std::vector<std::size_t> all_terms() const;

  /// The step to the minimum of the model, as far as it matters, and by how much chi2 falls with it; empty
  /// where that is at most `least_gain`.
  [[nodiscard]] Step step(double least_gain);
  /// Terms that were linearized where this step makes the model err, if they err by more than a share of the
  /// gain.
  [[nodiscard]] std::vector<std::size_t> stale_for(const Step& step);

  /// What new poses have changed.
  struct Replaced {
    std::vector<std::pair<std::size_t, P>> poses;  ///< As they were.
    std::vector<std::size_t> terms;                ///< That were evaluated.
    double cost = 0.0;                             ///< By how much it rose.
  };
  /// Moves the nodes by a step, all but those that it moves by `kSmallestStep` or less.
  Replaced take(const Step& step);
  /// Gives nodes these poses again, as `Replaced` has them.
  void put_back(const std::vector<std::pair<std::size_t, P>>& old);
  /// All poses but that of the first node, which stays.
  Replaced take_all(const std::vector<P>& poses);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  // An edge that is or was in use, at the present poses, and as the factor has it. Most loops never are in
  // use: terms lie by themselves, so that they are near one another.
  struct Term {
    Edge edge;
    bool is_used = false;
    bool is_in_factor = false;
    P T_linear;  // T_from_to where the factor's terms were linearized
    Tangent from = Tangent::Zero();
    Tangent to = Tangent::Zero();
    double turned = 0.0;  // of the relative pose since then, radians
    double moved = 0.0;   // likewise, metres
    double weight_of_rotation = 0.0;
    double weight_of_translation = 0.0;  // information, mean of the axes
    std::size_t visited_in = 0;          // pass
  };
  struct Node {
    Tangent gradient = Tangent::Zero();
    std::vector<std::size_t> terms;  // in use
    bool is_active = false;
    std::size_t visited_in = 0;
  };
  struct Squares {
    double moved = 0.0;   // metres^2
    double turned = 0.0;  // radians^2
  };
  enum class Change { added, removed };

  void change_factor(Term& term, Change change);
  void linearize_anew(Term& term);
  void evaluate(std::size_t t);
  [[nodiscard]] std::vector<std::size_t> terms_around(const std::vector<std::size_t>& nodes);
  void evaluate_around(Replaced& replaced);
  void sum_gradient(std::size_t node);
  void apply_changes();
  [[nodiscard]] static double change(const Term& term);
  [[nodiscard]] std::optional<std::size_t> refresh();
  [[nodiscard]] IncrementalCholesky::Sparse right_side();
  // Whether this is the first time in the present pass.
  [[nodiscard]] bool visit(std::size_t& visited_in) const {
    return std::exchange(visited_in, pass_) != pass_;
  }

  BasicPoseGraph<P> graph_;
  std::vector<P> poses_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> term_of_;  // edge; kNone of those that never were in use
  std::vector<Term> terms_;
  std::vector<double> costs_;         // of the terms in use; 0 of others
  std::vector<std::size_t> changed_;  // edges whose use changed
  std::vector<std::size_t> active_;   // nodes whose gradient may matter
  std::vector<Squares> squares_;      // scratch, by node: of a step; zero between
  std::size_t pass_ = 0;              // over edges or nodes
  IncrementalCholesky cholesky_{D};
  bool has_new_gradient_ = false;
  bool broken_ = false;  // the last refresh failed: the factor is of no use
};

}  // namespace adit
