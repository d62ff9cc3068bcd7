// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/jrl.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/jrl_records.hpp"

namespace adit {
namespace jrl {
namespace {

// Covariances are printed with all digits: more asymmetry than that, by the largest entry, is another matrix.
constexpr double kMaxAsymmetry = 1e-6;
// Two robots' copies of one measurement differ by rounding at most: metres and radians.
constexpr double kSamePose = 1e-12;
// By how much their sort keys may then differ at most, per metre of distance and one more.
constexpr double kSlackOfSortKey = 1e-10;
// Of an information matrix, reciprocal: below it the inverse in double precision has no correct digit.
constexpr double kLeastCondition = 1e-15;

// Their row of each of ours: GTSAM has rotation before translation in space, and the same order in the plane.
template <class P>
constexpr auto kTheirRow = [] {
  if constexpr (P::kDof == 6)
    return std::array<std::size_t, 6>{3, 4, 5, 0, 1, 2};
  else
    return std::array<std::size_t, 3>{0, 1, 2};
}();

// The inverse of the covariance, in our order.
template <class P>
Result<typename P::Jacobian> information_of(const std::vector<double>& covariance_as_written) {
  constexpr std::size_t D = P::kDof;
  using Matrix = typename P::Jacobian;
  Matrix covariance;
  for (std::size_t i = 0; i < D; ++i) {
    for (std::size_t j = 0; j < D; ++j)
      covariance(static_cast<int>(i), static_cast<int>(j)) =
          covariance_as_written[kTheirRow<P>[i] * D + kTheirRow<P>[j]];
  }
  const double largest = covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kMaxAsymmetry * largest)
    return fail("'covariance' is not symmetric; write it row by row");
  const Eigen::LLT<Matrix> factorization(0.5 * (covariance + covariance.transpose()));
  const bool is_definite = largest > 0.0 && factorization.info() == Eigen::Success;
  const Matrix information = is_definite ? Matrix(factorization.solve(Matrix::Identity())) : Matrix::Zero();
  if (!is_definite || !information.allFinite())
    return fail("'covariance' is not positive definite; give each direction a variance above zero");
  return Matrix(0.5 * (information + information.transpose()));
}

bool holds(const JrlFactorIds& ids, const std::string& robot, const JrlFactorId& id) {
  const auto found = ids->find(robot);
  return found != ids->end() && found->second.contains(id);
}

// Makes a graph of the records. P: the kind of pose that they hold.
template <class P>
class GraphMaker {
 public:
  explicit GraphMaker(JrlRecords records) : records_(std::move(records)) {}

  Result<JrlFile> make() {
    for (const JrlFactor& factor : records_.factors) {
      if (const Result<> added = add(factor); !added) return fail(factor.place, added.error());
    }
    const auto initial = poses_by_key(records_.initialization);
    if (!initial) return tl::unexpected(initial.error());
    const auto truth = poses_by_key(records_.truth);
    if (!truth) return tl::unexpected(truth.error());
    add_nodes(*initial, *truth);
    finish_edges();
    note();
    return JrlFile{std::move(records_.name), std::move(records_.robots), std::move(out_), std::move(places_),
                   std::move(notes_)};
  }

 private:
  using Edge = typename BasicPoseGraph<P>::Edge;
  using PosesByKey = std::map<std::uint64_t, P>;
  // By sort_key_of; one robot's, between the same ends.
  using EdgesByKey = std::multimap<std::pair<double, double>, std::size_t>;
  static constexpr int kDimension = P::kDof == 6 ? 3 : 2;
  struct KeyedEdge {
    std::uint64_t from;
    std::uint64_t to;
    Edge edge;
    std::size_t robot;
  };

  // By the letter of its key, or else whoever names it first.
  [[nodiscard]] std::size_t robot_of(std::uint64_t key, std::size_t named_by) const {
    const auto own = std::ranges::find(records_.robots, std::string(1, static_cast<char>(key >> 56U)));
    return own == records_.robots.end() ? named_by : static_cast<std::size_t>(own - records_.robots.begin());
  }

  Result<> add(const JrlFactor& factor) {
    const P* pose = std::get_if<P>(&factor.pose);
    if (pose == nullptr) return fail("both Pose2 and Pose3 factors in one file; split it in two");
    const auto information = information_of<P>(factor.covariance);
    if (!information) return tl::unexpected(information.error());
    for (const std::uint64_t key : factor.keys) robot_of_key_.try_emplace(key, robot_of(key, factor.robot));
    if (factor.keys.size() == 1) {
      prior_keys_.push_back(factor.keys.front());
      out_.priors.push_back({0, *pose, *information});
      return {};
    }
    const std::uint64_t from = factor.keys[0];
    const std::uint64_t to = factor.keys[1];
    if (from == to) return fail(format("a measurement from node {} to itself", from));
    KeyedEdge keyed{from, to, {0, 0, *pose, *information, kind_of(factor)}, factor.robot};
    if (is_repeated(keyed)) return {};
    edges_.push_back(std::move(keyed));
    out_.labels.push_back(label_of(factor));
    places_.push_back(factor.place);
    return {};
  }

  [[nodiscard]] EdgeKind kind_of(const JrlFactor& factor) const {
    const bool may_be_false = records_.potential
                                  ? holds(records_.potential, records_.robots[factor.robot], factor.id)
                                  : factor.keys[0] + 1 != factor.keys[1];
    return may_be_false ? EdgeKind::loop : EdgeKind::odometry;
  }
  [[nodiscard]] JrlLabel label_of(const JrlFactor& factor) const {
    if (!records_.outliers) return JrlLabel::unlabelled;
    return holds(records_.outliers, records_.robots[factor.robot], factor.id) ? JrlLabel::outlier
                                                                              : JrlLabel::inlier;
  }

  // Both robots of an encounter may have logged the same measurement; within one log it is a second one.
  [[nodiscard]] bool is_repeated(const KeyedEdge& keyed) {
    const auto [information, pose] = sort_key_of(keyed.edge);
    const double slack = kSlackOfSortKey * (1.0 + keyed.edge.T_from_to.translation().norm());
    auto& by_robot = edges_between_[{keyed.from, keyed.to}];
    for (const auto& [robot, edges] : by_robot) {
      if (robot == keyed.robot) continue;
      const auto end = edges.upper_bound({information, pose + slack});
      for (auto near = edges.lower_bound({information, pose - slack}); near != end; ++near) {
        const Edge& other = edges_[near->second].edge;
        if (other.information != keyed.edge.information) continue;
        if (!(other.T_from_to.inverse() * keyed.edge.T_from_to).log().isZero(kSamePose)) continue;
        ++num_repeated_;
        return true;
      }
    }
    by_robot[keyed.robot].emplace(std::pair(information, pose), edges_.size());
    return false;
  }

  // Equal matrices have equal first numbers, equal poses second ones that differ by rounding alone, and
  // others hardly ever: so that a measurement need not be compared with all others between its ends.
  [[nodiscard]] static std::pair<double, double> sort_key_of(const Edge& edge) {
    double information = 0.0;
    double weight = 1e-4;  // The sum of such entries stays finite.
    for (const double entry : edge.information.reshaped()) information += entry * (weight *= 1.07);
    typename P::Tangent generic;  // Roots have no small whole multiples that cancel, as steps of a grid have.
    for (int i = 0; i < P::kDof; ++i) generic[i] = std::sqrt(2.0 + i);
    const auto moved = (edge.T_from_to * generic.template head<kDimension>().eval()).eval();
    return {information, moved.dot(generic.template tail<kDimension>())};
  }

  // A robot's own word counts before that of others.
  [[nodiscard]] Result<PosesByKey> poses_by_key(const std::vector<JrlValue>& values) const {
    PosesByKey out;
    std::set<std::uint64_t> own;
    for (const JrlValue& value : values) {
      const P* pose = std::get_if<P>(&value.pose);
      if (pose == nullptr) return fail(value.place + ": a pose of another dimension than the factors'");
      const auto known = robot_of_key_.find(value.key);
      if (known == robot_of_key_.end() || known->second != value.robot) {
        out.emplace(value.key, *pose);
        continue;
      }
      if (!own.insert(value.key).second)
        return fail(format("{}: key {} comes twice", value.place, value.key));
      out.insert_or_assign(value.key, *pose);
    }
    return out;
  }

  void add_nodes(const PosesByKey& initial, const PosesByKey& truth) {
    for (const auto& [key, robot] : robot_of_key_) {
      const auto start = initial.find(key);
      const auto true_pose = truth.find(key);
      node_of_.emplace(key, out_.graph.nodes.size());
      out_.graph.nodes.push_back({key, start == initial.end() ? P() : start->second});
      out_.robot_of_node.push_back(robot);
      out_.truth.push_back(true_pose == truth.end() ? std::nullopt : std::optional(true_pose->second));
      is_known_.push_back(start != initial.end());
    }
  }

  void finish_edges() {
    for (KeyedEdge& keyed : edges_) {
      keyed.edge.from = node_of_.at(keyed.from);
      keyed.edge.to = node_of_.at(keyed.to);
      out_.graph.edges.push_back(std::move(keyed.edge));
    }
    for (std::size_t i = 0; i < prior_keys_.size(); ++i) out_.priors[i].node = node_of_.at(prior_keys_[i]);
    num_composed_ = static_cast<std::size_t>(std::ranges::count(is_known_, false));
    if (num_composed_ == 0) return;
    // Where nothing else is known, a prior says where to start.
    for (const auto& prior : out_.priors) {
      if (is_known_[prior.node]) continue;
      out_.graph.nodes[prior.node].pose = prior.T_world_node;
      is_known_[prior.node] = true;
    }
    const std::vector<P> poses = spanning_tree_poses(out_.graph, is_known_);
    for (std::size_t i = 0; i < poses.size(); ++i) out_.graph.nodes[i].pose = poses[i];
  }

  void note() {
    for (const auto& [type, count] : records_.left_out)
      notes_.push_back(
          format("{} factors of type {} are left out: adit solves poses from relative poses", count, type));
    if (num_repeated_ > 0)
      notes_.push_back(format("{} measurements that two robots repeat are counted once", num_repeated_));
    if (num_composed_ > 0)
      notes_.push_back(format("{} of {} poses have no initial value; they are composed along the edges",
                              num_composed_, out_.graph.nodes.size()));
    if (!records_.potential)
      notes_.emplace_back(
          "the file does not list potential outliers: every measurement but the step to the next key of a "
          "robot is taken for a loop");
    std::size_t trusted = 0;
    for (std::size_t e = 0; e < out_.labels.size(); ++e)
      trusted +=
          out_.labels[e] == JrlLabel::outlier && out_.graph.edges[e].kind == EdgeKind::odometry ? 1 : 0;
    if (trusted > 0)
      notes_.push_back(
          format("{} labelled outliers are not among the potential outliers and are trusted", trusted));
  }

  JrlRecords records_;
  JrlGraph<P> out_;
  std::vector<KeyedEdge> edges_;
  std::vector<std::uint64_t> prior_keys_;
  std::vector<std::string> places_;
  std::vector<std::string> notes_;
  std::map<std::uint64_t, std::size_t> robot_of_key_;
  std::map<std::uint64_t, std::size_t> node_of_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::map<std::size_t, EdgesByKey>> edges_between_;
  std::vector<bool> is_known_;
  std::size_t num_repeated_ = 0;
  std::size_t num_composed_ = 0;
};

Result<JrlFile> file_of(JrlRecords records) {
  const bool has_relative =
      std::ranges::any_of(records.factors, [](const JrlFactor& f) { return f.keys.size() == 2; });
  if (!has_relative)
    return fail("no BetweenFactorPose2 and no BetweenFactorPose3 in it: there is no pose graph to solve");
  if (std::holds_alternative<Pose2>(records.factors.front().pose))
    return GraphMaker<Pose2>(std::move(records)).make();
  return GraphMaker<Pose>(std::move(records)).make();
}

// Of the robot that a key names; 'a' where it names none.
char letter_of(std::uint64_t key) {
  const auto byte = static_cast<char>(key >> 56U);
  return byte == '\0' ? 'a' : byte;
}

// The other way: from a graph to records.
template <class P>
class RecordsMaker {
 public:
  RecordsMaker(const JrlFile& file, const JrlGraph<P>& log) : log_(log) {
    out_.name = file.name;
    out_.robots = file.robots;
    out_.potential.emplace();
    for (const std::string& robot : file.robots) (*out_.potential)[robot];
    const bool has_labels =
        std::ranges::any_of(log.labels, [](JrlLabel l) { return l != JrlLabel::unlabelled; });
    if (has_labels) out_.outliers = out_.potential;
  }

  JrlRecords make() {
    add_poses();
    for (const auto& prior : log_.priors)
      add({{log_.graph.nodes[prior.node].key},
           prior.T_world_node,
           covariance_of(prior.information),
           0,
           {},
           {}},
          prior.node);
    for (std::size_t e = 0; e < log_.graph.edges.size(); ++e) {
      const auto& edge = log_.graph.edges[e];
      const std::vector<std::uint64_t> keys = {log_.graph.nodes[edge.from].key,
                                               log_.graph.nodes[edge.to].key};
      const JrlFactorId id = add({keys, edge.T_from_to, covariance_of(edge.information), 0, {}, {}}, edge.to);
      const std::string& robot = out_.robots[log_.robot_of_node[edge.to]];
      if (edge.kind == EdgeKind::loop) (*out_.potential)[robot].insert(id);
      if (out_.outliers && log_.labels[e] == JrlLabel::outlier) (*out_.outliers)[robot].insert(id);
    }
    std::ranges::stable_sort(out_.factors, {}, [](const JrlFactor& f) { return std::pair(f.robot, f.id); });
    return std::move(out_);
  }

 private:
  void add_poses() {
    std::vector<std::size_t> nodes_of_robot(out_.robots.size(), 0);
    for (std::size_t i = 0; i < log_.graph.nodes.size(); ++i) {
      const std::size_t robot = log_.robot_of_node[i];
      entry_of_node_.push_back(nodes_of_robot[robot]++);
      out_.initialization.push_back({log_.graph.nodes[i].key, log_.graph.nodes[i].pose, robot, {}});
      if (i < log_.truth.size() && log_.truth[i])
        out_.truth.push_back({log_.graph.nodes[i].key, *log_.truth[i], robot, {}});
    }
  }

  [[nodiscard]] static std::vector<double> covariance_of(const typename P::Jacobian& information) {
    constexpr std::size_t D = P::kDof;
    const typename P::Jacobian covariance = information.inverse();
    std::vector<double> out(D * D);
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t k = 0; k < D; ++k)
        out[kTheirRow<P>[i] * D + kTheirRow<P>[k]] = covariance(static_cast<int>(i), static_cast<int>(k));
    return out;
  }

  JrlFactorId add(JrlFactor factor, std::size_t node) {
    factor.robot = log_.robot_of_node[node];
    const std::size_t entry = entry_of_node_[node];
    factor.id = {entry, num_in_entry_[{factor.robot, entry}]++};
    out_.factors.push_back(std::move(factor));
    return out_.factors.back().id;
  }

  const JrlGraph<P>& log_;
  JrlRecords out_;
  std::vector<std::size_t> entry_of_node_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> num_in_entry_;
};

}  // namespace
}  // namespace jrl

Result<JrlFile> jrl_of(std::string name, const std::variant<PoseGraph, PoseGraph2>& graph) {
  return std::visit(
      [&]<class P>(const BasicPoseGraph<P>& given) -> Result<JrlFile> {
        JrlGraph<P> log{given,
                        {},
                        {},
                        std::vector<std::optional<P>>(given.nodes.size()),
                        std::vector<JrlLabel>(given.edges.size(), JrlLabel::unlabelled)};
        std::map<char, std::size_t> robots;
        for (const auto& node : given.nodes) {
          const char letter = jrl::letter_of(node.key);
          if (letter < '!' || letter > '~') {
            return fail(
                format("the top byte of key {} is no letter of a robot; number nodes from 0, or as GTSAM's "
                       "Symbol does",
                       node.key));
          }
          robots.try_emplace(letter, 0);
        }
        JrlFile file{std::move(name), {}, {}, {}, {}};
        for (auto& [letter, number] : robots) {
          number = file.robots.size();
          file.robots.emplace_back(1, letter);
        }
        for (const auto& node : given.nodes) log.robot_of_node.push_back(robots.at(jrl::letter_of(node.key)));
        file.content = std::move(log);
        return file;
      },
      graph);
}

Result<std::string> jrl_text(const JrlFile& file) {
  return std::visit(
      [&]<class P>(const JrlGraph<P>& log) -> Result<std::string> {
        if (log.graph.edges.empty()) return fail("there are no edges, of which a JSON Robot Log is made");
        for (const auto& edge : log.graph.edges) {
          const Eigen::LLT<typename P::Jacobian> factorization(edge.information);
          if (factorization.info() == Eigen::Success && factorization.rcond() > jrl::kLeastCondition)
            continue;
          return fail(format(
              "the edge from {} to {} leaves a direction open and has no covariance, which a JSON Robot Log "
              "states; give it a little information there",
              log.graph.nodes[edge.from].key, log.graph.nodes[edge.to].key));
        }
        return jrl_text(jrl::RecordsMaker<P>(file, log).make());
      },
      file.content);
}

Result<JrlFile> parse_jrl(const std::string& bytes, const std::string& name) {
  Result<JrlFile> file = parse_jrl_records(bytes).and_then(jrl::file_of);
  return file ? std::move(file) : fail(name, file.error());
}

Result<JrlFile> read_jrl(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_jrl(*bytes, path.string());
}

template <class P>
BasicPoseGraph<P> with_priors_as_edges(const JrlGraph<P>& log) {
  BasicPoseGraph<P> graph = log.graph;
  if (log.priors.size() < 2) return graph;
  // Nodes are in the order of their keys.
  const std::uint64_t last = graph.nodes.back().key;
  const std::uint64_t first = graph.nodes.front().key;
  graph.nodes.push_back({first > 0 ? 0 : last + 1, P()});
  for (const auto& prior : log.priors)
    graph.edges.push_back(
        {graph.nodes.size() - 1, prior.node, prior.T_world_node, prior.information, EdgeKind::odometry});
  return graph;
}

template <class P>
std::vector<P> in_frame_of_priors(const JrlGraph<P>& log, std::vector<P> poses) {
  if (log.priors.empty()) return poses;
  const auto& prior = log.priors.front();
  const Components parts = connected_components(log.graph);
  const bool has_world = poses.size() > log.graph.nodes.size();
  const P T_world_given =
      has_world ? poses.back().inverse() : prior.T_world_node * poses[prior.node].inverse();
  std::vector<bool> is_held(parts.anchors.size(), false);
  for (const auto& p : log.priors) is_held[parts.of_node[p.node]] = true;
  poses.resize(log.graph.nodes.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (is_held[parts.of_node[i]]) poses[i] = T_world_given * poses[i];
  return poses;
}

template BasicPoseGraph<Pose> with_priors_as_edges(const JrlGraph<Pose>& jrl);
template BasicPoseGraph<Pose2> with_priors_as_edges(const JrlGraph<Pose2>& jrl);
template std::vector<Pose> in_frame_of_priors(const JrlGraph<Pose>& jrl, std::vector<Pose> poses);
template std::vector<Pose2> in_frame_of_priors(const JrlGraph<Pose2>& jrl, std::vector<Pose2> poses);

}  // namespace adit
