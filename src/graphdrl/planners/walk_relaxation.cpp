#include "graphdrl/planners/walk_relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>

#include "graphdrl/graph/blocks.h"

namespace graphdrl {
namespace {

constexpr double kViolation = 1e-4;     // less is not worth a row
constexpr double kIntegral = 1e-5;      // what is as near to a whole number is one
constexpr double kStepRounding = 1e-6;  // of a step, in which costs and prizes add up

// The largest number of which all values are multiples, if they are multiples of a simple fraction; else 0.
double common_step(const std::vector<double>& values) {
  constexpr double kMost = 1e9;  // steps in a value
  for (const double scale : {1.0, 2.0, 4.0, 8.0, 10.0, 16.0, 100.0, 1000.0}) {
    std::int64_t step = 0;
    bool whole = true;
    for (const double value : values) {
      const double scaled = value * scale;
      whole = whole && scaled <= kMost && std::abs(scaled - std::round(scaled)) <= 1e-9 * std::max(1.0, scaled) / kMost;
      if (whole) step = std::gcd(step, std::llround(scaled));
    }
    if (whole) return static_cast<double>(step) / scale;
  }
  return 0;
}

}  // namespace

WalkRelaxation::WalkRelaxation(const Task& task) : directed_(task.view.open().directed()) {
  const Reachable reachable(task);
  nodes_ = reachable.nodes;
  const Graph& open = task.view.open();
  std::vector<int> number(task.view.node_count(), -1);
  for (int i = 0; i < std::ssize(nodes_); ++i) number[nodes_[i]] = i;
  for (int i = 0; i < std::ssize(nodes_); ++i) {
    const auto neighbours = open.neighbours(nodes_[i]);
    for (int k = 0; k < std::ssize(neighbours); ++k) {
      const int to = number[neighbours[k]];
      if (to < 0 || (!directed_ && to < i) || open.cost(nodes_[i], k) > task.limit()) continue;
      arcs_.push_back({.from = i, .to = to, .cost = open.cost(nodes_[i], k), .once = -1, .twice = -1});
    }
  }
  at_.resize(nodes_.size());
  for (int arc = 0; arc < std::ssize(arcs_); ++arc) {
    at_[arcs_[arc].from].push_back(arc);
    at_[arcs_[arc].to].push_back(arc);
  }
  parent_.assign(nodes_.size(), -1);
  const Blocks blocks(open, task.view.into(), task.start, reachable.contains);
  for (int block = 0; block < blocks.count(); ++block) {
    if (blocks.root(block) == task.start) continue;
    for (const NodeId member : blocks.members(block)) parent_[number[member]] = number[blocks.root(block)];
  }
  place_.assign(nodes_.size(), -1);
  std::vector<int> stack = {0};
  for (int places = 0; !stack.empty();) {
    const int node = stack.back();
    stack.pop_back();
    if (place_[node] >= 0) continue;
    place_[node] = places++;
    for (const int arc : at_[node]) stack.push_back(arcs_[arc].from + arcs_[arc].to - node);
  }
  add_columns(task, reachable);
  add_rows(task);
  add_links();
}

void WalkRelaxation::add_columns(const Task& task, const Reachable& reachable) {
  std::vector<double> prizes;
  for (const NodeId node : nodes_) {
    const double prize = reachable.prizes[node];
    prizes.push_back(prize);
    visit_.push_back(program_.add_column(prize, node == task.start ? 1 : 0, 1));
    const bool may_end = task.ends_anywhere() || node == task.end;
    end_.push_back(may_end ? program_.add_column(0, 0, 1) : -1);
  }
  prize_step_ = common_step(prizes);
  const auto most_uses = static_cast<double>(nodes_.size());  // a way to each first visit uses an arc once at most
  for (Arc& arc : arcs_) {
    const double affordable = arc.cost > 0 ? std::floor(task.limit() / arc.cost) : most_uses;
    arc.once = program_.add_column(0, 0, directed_ ? std::min(affordable, most_uses) : 1);
    if (!directed_) arc.twice = program_.add_column(0, 0, affordable >= 2 ? 1 : 0);
  }
}

// Where the cost of a walk that ends there cannot be `budget` steps, for the one is odd and the other even. [n]
std::vector<bool> WalkRelaxation::odd_ends(double step, double budget) const {
  std::vector<int> colour(nodes_.size(), -1);
  std::vector<int> queue = {0};
  colour[0] = 0;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int node = queue[head];
    for (const int i : at_[node]) {
      const int next = arcs_[i].from + arcs_[i].to - node;
      const int other = static_cast<int>((colour[node] + std::llround(arcs_[i].cost / step)) % 2);
      if (colour[next] < 0) {
        colour[next] = other;
        queue.push_back(next);
      } else if (colour[next] != other) {
        return std::vector<bool>(nodes_.size());
      }
    }
  }
  std::vector<bool> odd(nodes_.size());
  for (std::size_t i = 0; i < odd.size(); ++i) odd[i] = (std::llround(budget) + colour[i]) % 2 != 0;
  return odd;
}

void WalkRelaxation::add_rows(const Task& task) {
  std::vector<LinearProgram::Row> rows;
  std::vector<double> costs;
  for (const Arc& arc : arcs_) costs.push_back(arc.cost);
  const double step = common_step(costs);
  LinearProgram::Row& cost = rows.emplace_back();
  cost.upper = step > 0 ? std::floor(task.limit() / step + kStepRounding) : task.limit();
  for (const Arc& arc : arcs_) add_uses(cost, arc, step > 0 ? std::round(arc.cost / step) : arc.cost);
  if (step > 0) {
    const std::vector<bool> odd = odd_ends(step, cost.upper);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (odd[i] && end_[i] >= 0) cost.add(end_[i], 1);
    }
  }
  LinearProgram::Row& ends = rows.emplace_back(LinearProgram::Row{.lower = 1, .upper = 1});
  for (const int end : end_) {
    if (end >= 0) ends.add(end, 1);
  }
  for (int i = 0; i < std::ssize(nodes_); ++i) {
    LinearProgram::Row arrivals{.lower = 0};
    LinearProgram::Row balance{.lower = i == 0 ? -1.0 : 0.0, .upper = i == 0 ? -1.0 : 0.0};
    for (const int arc : at_[i]) {
      if (!directed_ || arcs_[arc].to == i) add_uses(arrivals, arcs_[arc], 1);
      if (directed_) add_uses(balance, arcs_[arc], arcs_[arc].to == i ? 1 : -1);
    }
    if (end_[i] >= 0) (directed_ ? balance : arrivals).add(end_[i], directed_ ? -1 : 1);
    if (directed_) rows.push_back(std::move(balance));
    if (i == 0) continue;
    arrivals.add(visit_[i], directed_ ? -1 : -2);
    rows.push_back(std::move(arrivals));
  }
  program_.add_rows(rows);
  fixed_rows_ = program_.rows();
}

double WalkRelaxation::uses(const Arc& arc) const {
  return value(arc.once) + 2 * value(arc.twice);
}

void WalkRelaxation::add_uses(LinearProgram::Row& row, const Arc& arc, double factor) const {
  row.add(arc.once, factor);
  if (arc.twice >= 0) row.add(arc.twice, 2 * factor);
}

// Adds factor · z(S), S being the nodes for which `inside` says so; with fewer columns as factor · (1 - z(V \ S)).
void WalkRelaxation::add_ends(LinearProgram::Row& row, double factor, const std::vector<char>& inside) const {
  const auto count = std::count_if(inside.begin(), inside.end(), [](char in) { return in != 0; });
  const bool direct = 2 * count <= std::ssize(inside);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (end_[i] >= 0 && (inside[i] != 0) == direct) row.add(end_[i], direct ? factor : -factor);
  }
  if (direct) return;
  row.lower -= factor;
  row.upper -= factor;
}

int WalkRelaxation::separate() {
  found_.clear();
  separate_simple();
  if (!directed_) separate_parity();
  separate_connection();
  program_.add_rows(found_);
  return static_cast<int>(found_.size());
}

// The rows of ends, edges and blocks.
void WalkRelaxation::separate_simple() {
  const auto at_most = [&](double sum, const std::vector<int>& columns, int bound) {
    if (sum <= value(bound) + kViolation) return;
    LinearProgram::Row& row = found_.emplace_back();
    row.upper = 0;
    for (const int column : columns) row.add(column, 1);
    row.add(bound, -1);
  };
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    at_most(value(end_[i]), {end_[i]}, visit_[i]);
    if (parent_[i] >= 0) at_most(value(visit_[i]), {visit_[i]}, visit_[parent_[i]]);
  }
  if (directed_) return;
  for (const Arc& arc : arcs_) {
    const double used = value(arc.once) + value(arc.twice);
    for (const int node : {arc.from, arc.to}) at_most(used, {arc.once, arc.twice}, visit_[node]);
  }
}

// The components of the edges whose u is further than `fraction` from a whole number. [n]
std::vector<int> WalkRelaxation::components(double fraction) const {
  std::vector<int> component(nodes_.size(), -1);
  std::vector<int> queue;
  int count = 0;
  for (int root = 0; root < std::ssize(nodes_); ++root) {
    if (component[root] >= 0) continue;
    component[root] = count;
    queue.assign(1, root);
    while (!queue.empty()) {
      const int node = queue.back();
      queue.pop_back();
      for (const int i : at_[node]) {
        const int next = arcs_[i].from + arcs_[i].to - node;
        const double once = value(arcs_[i].once);
        if (component[next] >= 0 || std::min(once, 1 - once) <= fraction) continue;
        component[next] = count;
        queue.push_back(next);
      }
    }
    ++count;
  }
  return component;
}

// Each node alone, and what hangs together by edges that are not integral, by more and more of a fraction.
void WalkRelaxation::separate_parity() {
  std::set<std::vector<int>> tried;
  for (const double fraction : {1.0, 0.01, 0.1, 0.2, 0.3, 0.4}) {
    std::vector<int> component = components(fraction);
    if (tried.insert(component).second) separate_parity_of(component);
  }
}

// For each component the violation is least where F is what is nearer to 1 than to 0, but for one where that is an even
// number.
void WalkRelaxation::separate_parity_of(const std::vector<int>& component) {
  struct Cut {
    double distance = 0;  // of all values from the nearest whole number
    double flip = 1;      // how much further one of them is from the other, at least
    bool odd = false;     // how many are nearer to 1
    double end = 0;
    double size = 0;

    void add(double part) {
      distance += std::min(part, 1 - part);
      flip = std::min(flip, std::abs(1 - 2 * part));
      odd = odd != (part > 0.5);
    }
  };
  std::vector<Cut> cuts(1 + *std::max_element(component.begin(), component.end()));
  for (const Arc& arc : arcs_) {
    if (component[arc.from] == component[arc.to]) continue;
    for (const int node : {arc.from, arc.to}) cuts[component[node]].add(value(arc.once));
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    cuts[component[i]].end += value(end_[i]);
    cuts[component[i]].size += 1;
  }
  std::vector<double> seen;
  for (int which = 0; which < std::ssize(cuts); ++which) {
    Cut& cut = cuts[which];
    cut.add(std::clamp(which == component[0] ? 1 - cut.end : cut.end, 0.0, 1.0));
    if (cut.distance + (cut.odd ? 0 : cut.flip) < 1 - kViolation) add_parity_row(component, which);
  }
}

void WalkRelaxation::add_parity_row(const std::vector<int>& component, int which) {
  struct Term {
    int column;  // -1 for z(S)
    double value;
  };
  std::vector<char> inside(nodes_.size());
  double end = 0;
  const bool turned = component[0] == which;  // S is without the start
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    inside[i] = static_cast<char>((component[i] == which) != turned);
    if (inside[i] != 0) end += value(end_[i]);
  }
  std::vector<Term> terms = {{-1, end}};
  for (const Arc& arc : arcs_) {
    if (inside[arc.from] != inside[arc.to]) terms.push_back({arc.once, value(arc.once)});
  }
  std::vector<char> in_f;
  int odd = 0;
  std::size_t flipped = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    in_f.push_back(static_cast<char>(terms[i].value > 0.5));
    odd ^= in_f.back();
    if (std::abs(1 - 2 * terms[i].value) < std::abs(1 - 2 * terms[flipped].value)) flipped = i;
  }
  if (odd == 0) in_f[flipped] = static_cast<char>(1 - in_f[flipped]);
  // Sum of (1 - value) over F and of value over the others >= 1.
  LinearProgram::Row& row = found_.emplace_back();
  row.lower = 1 - static_cast<double>(std::count(in_f.begin(), in_f.end(), 1));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double factor = in_f[i] != 0 ? -1 : 1;
    if (terms[i].column < 0) {
      add_ends(row, factor, inside);
    } else {
      row.add(terms[i].column, factor);
    }
  }
}

void WalkRelaxation::add_links() {
  const auto link = [&](int from, int to, int arc) {
    links_[from].push_back({.to = to, .arc = arc, .reverse = static_cast<int>(links_[to].size())});
    links_[to].push_back({.to = from, .arc = -1, .reverse = static_cast<int>(links_[from].size()) - 1});
  };
  links_.resize(nodes_.size());
  for (int i = 0; i < std::ssize(arcs_); ++i) {
    link(arcs_[i].to, arcs_[i].from, i);
    if (!directed_) links_[arcs_[i].from].back().arc = i;  // its other side is the edge the other way
  }
  capacity_.resize(nodes_.size());
}

// In order of y, so that a node once found connected well enough is in no violated S of those to come: it counts as the
// start for them, and flows end soon.
void WalkRelaxation::separate_connection() {
  for (int node = 0; node < std::ssize(nodes_); ++node) {
    capacity_[node].clear();
    for (const Link& link : links_[node]) capacity_[node].push_back(link.arc < 0 ? 0 : uses(arcs_[link.arc]));
  }
  std::vector<int> order(nodes_.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(),
                   [&](int one, int other) { return value(visit_[one]) > value(visit_[other]); });
  settled_.assign(nodes_.size(), 0);
  settled_[0] = 1;
  std::vector<char> cut_off(nodes_.size());
  for (const int node : order) {
    const double needed = (directed_ ? 1 : 2) * value(visit_[node]) - kViolation;
    if (needed <= 0) break;
    if (cut_off[node] != 0) continue;
    if (flow_reaches(node, needed)) {
      settled_[node] = 1;
      continue;
    }
    add_connection_row(node);
    for (const int other : reached_) cut_off[other] = 1;
  }
}

// Whether so much flows from a node to settled ones, ends counting as ways to the start; else reached_ is S. Leaves the
// capacities as they were. Augmenting paths, shortest first [Edmonds and Karp 1972].
bool WalkRelaxation::flow_reaches(int node, double needed) {
  struct Used {
    int from;
    int link;
    double flow;
  };
  std::vector<Used> used;
  std::vector<double> end_left(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) end_left[i] = directed_ ? 0 : value(end_[i]);
  std::vector<Used> came(nodes_.size());  // from where, by which link
  double flow = 0;
  while (flow < needed) {
    inside_.assign(nodes_.size(), 0);
    inside_[node] = 1;
    reached_.assign(1, node);
    int last = -1;  // where a path leaves
    bool by_end = false;
    for (std::size_t head = 0; head < reached_.size() && last < 0; ++head) {
      const int here = reached_[head];
      if (end_left[here] > kIntegral) {
        last = here;
        by_end = true;
        break;
      }
      for (int i = 0; i < std::ssize(links_[here]); ++i) {
        const int next = links_[here][i].to;
        if (inside_[next] != 0 || capacity_[here][i] <= kIntegral) continue;
        inside_[next] = 1;
        came[next] = {here, i, 0};
        if (settled_[next] != 0) {
          last = next;
          break;
        }
        reached_.push_back(next);
      }
    }
    if (last < 0) break;
    double most = by_end ? end_left[last] : kNoLimit;
    for (int at = last; at != node; at = came[at].from) most = std::min(most, capacity_[came[at].from][came[at].link]);
    if (by_end) end_left[last] -= most;
    for (int at = last; at != node; at = came[at].from) {
      const auto [from, i, unused] = came[at];
      capacity_[from][i] -= most;
      capacity_[at][links_[from][i].reverse] += most;
      used.push_back({from, i, most});
    }
    flow += most;
  }
  for (const Used& part : used) {
    const Link& link = links_[part.from][part.link];
    capacity_[part.from][part.link] += part.flow;
    capacity_[link.to][link.reverse] -= part.flow;
  }
  return flow >= needed;
}

void WalkRelaxation::add_connection_row(int node) {
  inside_.assign(nodes_.size(), 0);
  for (const int other : reached_) inside_[other] = 1;
  LinearProgram::Row& row = found_.emplace_back();
  row.lower = 0;
  for (const Arc& arc : arcs_) {
    const bool crosses =
        directed_ ? inside_[arc.to] != 0 && inside_[arc.from] == 0 : inside_[arc.to] != inside_[arc.from];
    if (crosses) add_uses(row, arc, 1);
  }
  if (!directed_) add_ends(row, 1, inside_);
  row.add(visit_[node], directed_ ? -1 : -2);
}

WalkRelaxation::Branches WalkRelaxation::branches() const {
  Branches result;
  // First, half of the ends.
  std::vector<int> ends;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (end_[i] >= 0 && program_.upper(end_[i]) > 0) ends.push_back(static_cast<int>(i));
  }
  std::sort(ends.begin(), ends.end(), [&](int one, int other) { return place_[one] < place_[other]; });
  double sum = 0;
  double best = kIntegral;
  std::size_t split = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    sum += value(end_[ends[i]]);
    if (std::min(sum, 1 - sum) <= best) continue;
    best = std::min(sum, 1 - sum);
    split = i + 1;
  }
  if (split > 0) {
    for (std::size_t i = 0; i < ends.size(); ++i) {
      (i < split ? result.second : result.first).push_back({end_[ends[i]], 0, 0});
    }
    return result;
  }
  // Then a visit, then an edge: what is least integral.
  const auto split_at = [&](int column) {
    const double down = std::floor(value(column) + kIntegral);
    result.first = {{column, down + 1, program_.upper(column)}};
    result.second = {{column, program_.lower(column), down}};
  };
  const auto least_integral = [&](const std::vector<int>& columns) {
    int found = -1;
    double most = kIntegral;
    for (const int column : columns) {
      const double fraction = std::abs(value(column) - std::round(value(column)));
      if (fraction > most) {
        most = fraction;
        found = column;
      }
    }
    if (found >= 0) split_at(found);
    return found >= 0;
  };
  if (least_integral(visit_)) return result;
  std::vector<int> uses;
  for (const Arc& arc : arcs_) {
    uses.push_back(arc.once);
    if (arc.twice >= 0) uses.push_back(arc.twice);
  }
  least_integral(uses);
  return result;
}

// An Eulerian trail of the part that hangs together with the start [Hierholzer 1873].
std::vector<NodeId> WalkRelaxation::walk() const {
  std::vector<int> left;
  for (const Arc& arc : arcs_) left.push_back(static_cast<int>(std::llround(uses(arc))));
  std::vector<std::size_t> looked_at(nodes_.size());
  std::vector<int> stack = {0};
  std::vector<NodeId> walk;
  while (!stack.empty()) {
    const int node = stack.back();
    std::size_t& i = looked_at[node];
    while (i < at_[node].size() && (left[at_[node][i]] == 0 || (directed_ && arcs_[at_[node][i]].to == node))) ++i;
    if (i == at_[node].size()) {
      walk.push_back(nodes_[node]);
      stack.pop_back();
      continue;
    }
    const Arc& arc = arcs_[at_[node][i]];
    --left[at_[node][i]];
    stack.push_back(arc.from + arc.to - node);
  }
  std::reverse(walk.begin(), walk.end());
  return walk;
}

}  // namespace graphdrl
