// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The same least-squares problems in Ceres, tuned as well as we can: exact derivatives written out, sparse
/// Cholesky of SuiteSparse, a trust region that lets Gauss-Newton steps through.
#include <ceres/ceres.h>
#include <ceres/version.h>

#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "harness/bench_case.hpp"
#include "posegraph_inputs.hpp"

namespace adit::bench {
namespace {

// Parameters of a pose: quaternion (x y z w) and translation, or x y theta.
using Parameters3 = Eigen::Matrix<double, 7, 1>;
Parameters3 parameters_of(const Pose& T) {
  Parameters3 p;
  p << Eigen::Quaterniond(T.rotation_matrix()).coeffs(), T.translation();
  return p;
}
Pose pose_of(const double* p) {
  return {Eigen::Map<const Eigen::Quaterniond>(p).toRotationMatrix(), Eigen::Map<const Vector3>(p + 4)};
}

// Steps by our `retract`. Cost functions give derivatives with respect to the step already, in their first
// six columns, so that nothing is lost in a change of parameters.
class PoseManifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    const Parameters3 moved = parameters_of(retract(pose_of(x), Vector6(Eigen::Map<const Vector6>(delta))));
    std::copy_n(moved.data(), 7, out);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

class Between3 final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  Between3(const PoseGraph::Edge& edge) : T_(edge.T_from_to), root_(edge.information.llt().matrixU()) {}
  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    Eigen::Map<Vector6> r(residual);
    if (jacobians == nullptr) {
      r = root_ * between_residual(T_, pose_of(p[0]), pose_of(p[1]));
      return true;
    }
    const BetweenFactor<Pose> f = linearize(T_, pose_of(p[0]), pose_of(p[1]));
    r = root_ * f.residual;
    for (int i = 0; i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> jacobian(jacobians[i]);
      jacobian << root_ * (i == 0 ? f.d_from : f.d_to), Vector6::Zero();
    }
    return true;
  }

 private:
  Pose T_;
  Matrix6 root_;
};

class Pose2Manifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 3; }
  [[nodiscard]] int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    const Pose2 T = retract(Pose2(x[0], x[1], x[2]), Vector3(delta[0], delta[1], delta[2]));
    out[0] = T.translation().x();
    out[1] = T.translation().y();
    out[2] = T.theta();
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

class Between2 final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  Between2(const PoseGraph2::Edge& edge) : T_(edge.T_from_to), root_(edge.information.llt().matrixU()) {}
  bool Evaluate(const double* const* p, double* residual, double** jacobians) const override {
    const BetweenFactor<Pose2> f =
        linearize(T_, Pose2(p[0][0], p[0][1], p[0][2]), Pose2(p[1][0], p[1][1], p[1][2]));
    Eigen::Map<Vector3> r(residual);
    r = root_ * f.residual;
    for (int i = 0; jacobians != nullptr && i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> jacobian(jacobians[i]);
      jacobian = root_ * (i == 0 ? f.d_from : f.d_to);
    }
    return true;
  }

 private:
  Pose2 T_;
  Matrix3 root_;
};

Figures solved(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = num_threads();
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = 1e-6;
  options.max_num_iterations = 100;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {{"chi2", 2.0 * summary.final_cost},
          {"iterations", static_cast<double>(summary.iterations.size()) - 1.0}};
}

// One problem serves all runs; each starts from the file's guess again.
template <class Parameters, class Between, class Manifold>
struct Model {
  std::vector<Parameters> guess;
  std::vector<Parameters> x;
  ceres::Problem problem;

  template <class Graph, class ToParameters>
  Model(const Graph& graph, const ToParameters& to_parameters) {
    for (const auto& node : graph.nodes) guess.push_back(to_parameters(node.pose));
    x = guess;
    auto* manifold = new Manifold();
    for (auto& p : x) problem.AddParameterBlock(p.data(), static_cast<int>(p.size()), manifold);
    for (const auto& edge : graph.edges)
      problem.AddResidualBlock(new Between(edge), nullptr, x[edge.from].data(), x[edge.to].data());
    problem.SetParameterBlockConstant(x.front().data());
  }
};

Work optimizing(const std::string& name) {
  const auto graph = shared_graph(name);
  if (const auto* space = std::get_if<PoseGraph>(&graph)) {
    auto model = std::make_shared<Model<Parameters3, Between3, PoseManifold>>(*space, parameters_of);
    return [model] {
      model->x = model->guess;
      return solved(model->problem);
    };
  }
  const auto to_parameters = [](const Pose2& T) {
    return Vector3(T.translation().x(), T.translation().y(), T.theta());
  };
  auto model =
      std::make_shared<Model<Vector3, Between2, Pose2Manifold>>(std::get<PoseGraph2>(graph), to_parameters);
  return [model] {
    model->x = model->guess;
    return solved(model->problem);
  };
}

// Ceres from adit's chordal start, which is timed: what a user does whose guess leads to a poor minimum.
Work optimizing_from_chordal(const std::string& name) {
  const PoseGraph graph = std::get<PoseGraph>(shared_graph(name));
  auto model = std::make_shared<Model<Parameters3, Between3, PoseManifold>>(graph, parameters_of);
  return [model, graph] {
    OptimizerConfig chordal;
    chordal.initialization = SolveStart::chordal;
    chordal.max_iterations = 0;
    const Solution<Pose> start = optimize(graph, chordal);
    for (std::size_t i = 0; i < start.poses.size(); ++i) model->x[i] = parameters_of(start.poses[i]);
    return solved(model->problem);
  };
}

// Without these settings Debian's OpenBLAS and CHOLMOD start threads of their own and do not recognise new
// processors: Ceres is then twice as slow.
About about_ceres(const std::string& start) {
  return {
      .version = "Ceres " CERES_VERSION_STRING,
      .build = "Debian 12 package, with its SuiteSparse and OpenBLAS",
      .timed =
          "from the problem in memory to the minimum: analysis of its structure, start (" + start +
          "), all iterations; exact Jacobians, sparse Cholesky, trust region 1e8, relative tolerance 1e-6",
      .environment = {
          {"OMP_THREAD_LIMIT", "1"}, {"OPENBLAS_NUM_THREADS", "1"}, {"OPENBLAS_CORETYPE", "Haswell"}}};
}

const struct CeresSides {
  CeresSides() {
    for (const BenchGraph& graph : kGraphs) {
      const std::string name = graph.name;
      const auto from_guess = [name] { return optimizing(name); };
      const auto from_chordal = [name] { return optimizing_from_chordal(name); };
      const About guess = about_ceres("the guess in the file");
      const About chordal = about_ceres("adit's chordal relaxation");
      Side("posegraph/" + name, "ceres", from_guess, guess);
      Side("posegraph/" + name + "_from_guess", "ceres", from_guess, guess);
      if (name == "city10000") continue;
      Side("posegraph/" + name, "ceres-chordal", from_chordal, chordal);
      Side("posegraph/" + name + "_from_chordal", "ceres", from_chordal, chordal);
    }
  }
} ceres_sides;

}  // namespace
}  // namespace adit::bench
