// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/frame_tree.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "adit/core/format.hpp"

namespace adit {

std::string FrameTree::bare(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return std::string(frame);
}

void FrameTree::add(std::string_view frame, std::string_view child, const Pose& T_frame_child) {
  if (bare(frame) != bare(child)) links_.insert_or_assign(bare(child), Link{bare(frame), T_frame_child});
}

std::vector<std::string> FrameTree::up_to_root(const std::string& frame) const { return up_to(frame, {}); }

std::vector<std::string> FrameTree::up_to(const std::string& frame, const Roots& roots) const {
  std::vector<std::string> path = {frame};
  std::set<std::string_view> passed = {frame};
  for (auto link = links_.find(frame); link != links_.end(); link = links_.find(path.back())) {
    if (roots.contains(path.back())) break;
    path.push_back(link->second.parent);
    if (!passed.insert(link->second.parent).second) break;
  }
  return path;
}

Result<FrameTree::Chain> FrameTree::between(std::string_view a, std::string_view b) const {
  const std::vector<std::string> up = up_to_root(bare(a));
  const std::vector<std::string> down = up_to_root(bare(b));
  const auto top = std::ranges::find_first_of(up, down);
  if (top == up.end()) return fail(format("no links connect '{}' and '{}'", bare(a), bare(b)));
  for (const auto* path : {&up, &down}) {
    if (std::set(path->begin(), path->end()).size() < path->size())
      return fail(format("the links above '{}' run in a circle", path->front()));
  }
  const auto top_of_b = std::ranges::find(down, *top);
  Chain chain;
  chain.frames.assign(up.begin(), top + 1);
  chain.frames.insert(chain.frames.end(), std::reverse_iterator(top_of_b), down.rend());
  // A single link is handed on bit for bit: no product with the identity.
  std::optional<Pose> product;
  const auto append = [&](const Pose& T) { product = product ? *product * T : T; };
  for (auto frame = up.begin(); frame != top; ++frame) append(links_.at(*frame).T_parent_child.inverse());
  for (auto frame = std::reverse_iterator(top_of_b); frame != down.rend(); ++frame)
    append(links_.at(*frame).T_parent_child);
  chain.T_a_b = product.value_or(Pose());
  return chain;
}

std::string FrameTree::body_of(std::string_view frame) const {
  Roots roots;  // each frame is walked over once, however long the chains are
  const auto root_of = [&](const std::string& of) {
    const std::vector<std::string> path = up_to(of, roots);
    const auto known = roots.find(path.back());
    const std::string root = known == roots.end() ? path.back() : known->second;
    for (const std::string& name : path) roots.emplace(name, root);
    return root;
  };
  const std::string root = root_of(bare(frame));
  std::vector<std::string> linked;
  for (const std::string& other : frames())
    if (root_of(other) == root) linked.push_back(other);
  if (std::ranges::find(linked, bare(frame)) == linked.end()) return "";
  for (const std::string_view name : std::array{"base_footprint", "base_link", "base", "body"}) {
    const auto body = std::ranges::find_if(linked, [&](const std::string& other) {
      return other.substr(other.rfind('/') + 1) == name;  // npos + 1 = 0: the whole name
    });
    if (body != linked.end()) return *body;
  }
  return root;
}

std::vector<std::string> FrameTree::frames() const {
  std::set<std::string> all;
  for (const auto& [child, link] : links_) all.insert({child, link.parent});
  return {all.begin(), all.end()};
}

}  // namespace adit
