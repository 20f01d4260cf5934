#include "graphdrl/planners/two_matching.h"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <utility>

namespace graphdrl {
namespace {

constexpr double kMeanRounding = 1e-9;  // relative, of a mean
constexpr int kMostHops = 6;            // that an end makes: on maps of cells more than two hardly ever pay
constexpr int kMostLooks = 256;         // from a node, at those two steps away: hubs have more
constexpr int kMostSearches = 40;       // each of which is linear

}  // namespace

TwoMatching::TwoMatching(const Graph& graph, std::span<const NodeId> nodes)
    : graph_(graph),
      most_cost_(graph.mean_cost() * (1 + kMeanRounding)),
      nodes_(nodes.begin(), nodes.end()),
      covered_(graph.node_count()),
      wanted_(graph.node_count()),
      links_(graph.node_count(), {kNoNode, kNoNode}) {
  for (const NodeId node : nodes_) {
    covered_[node] = 1;
    wanted_[node] = 2;
  }
}

void TwoMatching::link(NodeId a, NodeId b) {
  links_[a][links_[a][0] == kNoNode ? 0 : 1] = b;
  links_[b][links_[b][0] == kNoNode ? 0 : 1] = a;
}

void TwoMatching::unlink(NodeId a, NodeId b) {
  links_[a][links_[a][0] == b ? 0 : 1] = kNoNode;
  links_[b][links_[b][0] == a ? 0 : 1] = kNoNode;
}

void TwoMatching::grow_paths() {
  std::vector<int> left(graph_.node_count());  // neighbours that are on no path
  std::vector<char> taken(graph_.node_count());
  for (const NodeId node : nodes_) {
    const auto neighbours = graph_.neighbours(node);
    for (int i = 0; i < std::ssize(neighbours); ++i) left[node] += usable(node, i) ? 1 : 0;
  }
  const auto take = [&](NodeId node) {
    taken[node] = 1;
    for (const NodeId next : graph_.neighbours(node)) --left[next];
  };
  const auto grow = [&](NodeId node) {
    for (;;) {
      const auto neighbours = graph_.neighbours(node);
      NodeId best = kNoNode;
      for (int i = 0; i < std::ssize(neighbours); ++i) {
        const NodeId next = neighbours[i];
        if (taken[next] == 0 && usable(node, i) && (best == kNoNode || left[next] < left[best])) best = next;
      }
      if (best == kNoNode || !is_end(best)) return;
      link(node, best);
      take(best);
      node = best;
      if (!is_end(node)) return;
    }
  };
  for (const NodeId node : nodes_) {
    if (taken[node] != 0) continue;
    take(node);
    for (int side = 0; side < wanted_[node]; ++side) grow(node);
  }
}

// A forest of alternating paths from all ends at once. From an end an edge that is no link leads to an inner node, from
// there a link to an outer node, and so on: once the links along such a path change places with the other edges, the
// outer node is the end. A hop leads from an outer node to an inner one two steps away.
class TwoMatching::EndSearch {
 public:
  explicit EndSearch(TwoMatching& matching) : matching_(matching), marks_(matching.graph_.node_count()) {}

  // Grows the forest until each tree has met another one, and joins those. Gives how many it joined.
  int run() {
    std::fill(marks_.begin(), marks_.end(), Mark());
    for (auto& queue : queues_) queue.clear();
    for (const NodeId node : matching_.nodes_) {
      if (matching_.is_end(node)) enter(node, {.root = node, .outer = true}, 0);
    }
    joined_ = 0;
    if (queues_[0].size() < 2) return 0;
    for (int hops = 0; hops <= kMostHops; ++hops) {
      for (std::size_t i = 0; i < queues_[hops].size(); ++i) step_from(queues_[hops][i], hops);
      for (std::size_t i = 0; i < queues_[hops].size(); ++i) hop_from(queues_[hops][i], hops);
    }
    return joined_;
  }

 private:
  struct Mark {
    NodeId root = kNoNode;    // of the tree; kNoNode outside
    NodeId parent = kNoNode;  // kNoNode of a root
    NodeId over = kNoNode;    // of an inner node that a hop leads to
    bool outer = false;
    bool joined = false;  // of a root: its tree is done
  };

  bool is_done(NodeId node) const { return marks_[marks_[node].root].joined; }

  void enter(NodeId node, const Mark& mark, int hops) {
    marks_[node] = mark;
    if (mark.outer) queues_[hops].push_back(node);
  }

  void enter_inner(NodeId node, NodeId parent, NodeId over, int hops) {
    const NodeId root = marks_[parent].root;
    enter(node, {.root = root, .parent = parent, .over = over}, hops);
    for (const NodeId next : matching_.links_[node]) {
      if (next == kNoNode || marks_[next].root != kNoNode) continue;
      enter(next, {.root = root, .parent = node, .outer = true}, hops);
    }
  }

  void step_from(NodeId node, int hops) {
    const auto neighbours = matching_.graph_.neighbours(node);
    for (int i = 0; i < std::ssize(neighbours) && !is_done(node); ++i) {
      const NodeId next = neighbours[i];
      if (!matching_.usable(node, i) || matching_.linked(node, next)) continue;
      const Mark& there = marks_[next];
      if (there.root == kNoNode) {
        if (matching_.wanted_[next] > 0) enter_inner(next, node, kNoNode, hops);
      } else if (there.outer && there.root != marks_[node].root && !is_done(next)) {
        end_at(node);
        end_at(next);
        matching_.link(node, next);
      }
    }
  }

  void hop_from(NodeId node, int hops) {
    int looks = 0;
    for (const NodeId over : matching_.graph_.neighbours(node)) {
      for (const NodeId next : matching_.graph_.neighbours(over)) {
        if (is_done(node) || ++looks > kMostLooks) return;
        if (matching_.covered_[next] == 0 || next == node) continue;
        const Mark& there = marks_[next];
        if (there.root == kNoNode) {
          const bool goes_on = hops < kMostHops && !matching_.linked(node, next) && matching_.degree(next) > 0;
          if (goes_on) enter_inner(next, node, over, hops + 1);
        } else if (there.outer && there.root != marks_[node].root && !is_done(next)) {
          end_at(node);
          end_at(next);
          hop(node, over, next);
        }
      }
    }
  }

  void hop(NodeId from, NodeId over, NodeId to) {
    matching_.hops_.push_back({from, over, to});
    --matching_.wanted_[from];
    --matching_.wanted_[to];
  }

  // The end of an outer node's tree moves there.
  void end_at(NodeId outer) {
    marks_[marks_[outer].root].joined = true;
    ++joined_;
    const auto for_steps = [&](const auto& visit) {
      for (NodeId node = outer; marks_[node].parent != kNoNode; node = marks_[marks_[node].parent].parent) {
        visit(marks_[marks_[node].parent].parent, marks_[node].parent, node);
      }
    };
    for_steps([&](NodeId, NodeId inner, NodeId next) { matching_.unlink(inner, next); });
    for_steps([&](NodeId before, NodeId inner, NodeId) {
      if (marks_[inner].over == kNoNode) {
        matching_.link(before, inner);
      } else {
        hop(before, marks_[inner].over, inner);
      }
    });
  }

  TwoMatching& matching_;
  std::vector<Mark> marks_;                                // [N]
  std::array<std::vector<NodeId>, kMostHops + 2> queues_;  // outer nodes, by hops
  int joined_ = 0;
};

void TwoMatching::join_ends(const Clock& clock) {
  EndSearch search(*this);
  for (int i = 0; i < kMostSearches && !clock.passed() && search.run() > 0; ++i) {
  }
}

void TwoMatching::patch_cycles() {
  boost::disjoint_sets_with_storage<> parts(graph_.node_count());
  std::vector<char> is_cycle(graph_.node_count(), 1);  // by the representative of a part
  for (const NodeId node : nodes_) {
    for (const NodeId next : links_[node]) {
      if (next != kNoNode) parts.union_set(node, next);
    }
  }
  for (const NodeId node : nodes_) {
    if (degree(node) < 2) is_cycle[parts.find_set(node)] = 0;
  }
  // Of two links side by side, a–b and c–d, makes a–c and b–d.
  const auto patch = [&](NodeId a, NodeId b) {
    const auto neighbours = graph_.neighbours(a);
    for (int i = 0; i < std::ssize(neighbours); ++i) {
      const NodeId c = neighbours[i];
      if (c == b || !usable(a, i) || linked(a, c)) continue;
      const auto mine = parts.find_set(a);
      const auto its = parts.find_set(c);
      if (mine == its || (is_cycle[mine] == 0 && is_cycle[its] == 0)) continue;
      for (const NodeId d : links_[c]) {
        if (d == kNoNode) continue;
        const int index = graph_.index_of(b, d);
        if (index < 0 || !usable(b, index)) continue;
        unlink(a, b);
        unlink(c, d);
        link(a, c);
        link(b, d);
        const bool both = is_cycle[mine] != 0 && is_cycle[its] != 0;
        parts.link(mine, its);
        is_cycle[parts.find_set(a)] = both ? 1 : 0;
        return true;
      }
    }
    return false;
  };
  for (bool patched = true; patched;) {
    patched = false;
    for (const NodeId node : nodes_) {
      while ((links_[node][0] != kNoNode && patch(node, links_[node][0])) ||
             (links_[node][1] != kNoNode && patch(node, links_[node][1]))) {
        patched = true;
      }
    }
  }
}

}  // namespace graphdrl
