#include "graphdrl/planners/walk_relaxation.h"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include "graphdrl/graph/components.h"

namespace graphdrl {
namespace {

constexpr int kProbed = 8;                // columns to try branching on
constexpr int kProbeIterations = 30;      // each way
constexpr double kMostFall = 1e3;         // of a bound, in prizes: a part without walks counts as this
constexpr double kLeastTrialFall = 1e-3;  // added to each of two falls: their product tells columns apart if one is 0
constexpr double kViolation = 1e-4;       // less is not worth a row
constexpr double kIntegral = 1e-5;        // what is as near to a whole number is one

// The largest step of which all values are multiples, if they are multiples of a simple fraction; else 0.
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

// How far a part of 1 is from a whole number.
double from_whole(double part) {
  return std::min(part, 1 - part);
}

}  // namespace

WalkRelaxation::WalkRelaxation(const Task& task)
    : directed_(task.view().open().directed()),
      nodes_(task.reach().nodes),
      network_(static_cast<int>(task.reach().nodes.size()) + 1) {
  const Graph& open = task.view().open();
  std::vector<int> number(task.view().node_count(), -1);
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
  const Blocks blocks(task.view().both_ways(), task.start(), task.reach().contains);
  for (int block = 0; block < blocks.count(); ++block) {
    if (blocks.root(block) == task.start()) continue;
    for (const NodeId member : blocks.members(block)) parent_[number[member]] = number[blocks.root(block)];
  }
  std::vector<char> met(nodes_.size());
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    if (std::exchange(met[node], 1) != 0) continue;
    depth_first_.push_back(node);
    for (const int arc : at_[node]) stack.push_back(arcs_[arc].other_end(node));
  }
  add_columns(task);
  add_rows(task);
  const int count = static_cast<int>(nodes_.size());
  for (const Arc& arc : arcs_) network_.add_arc(arc.to, arc.from, 0);
  for (int node = 0; node < count; ++node) to_start_.push_back(network_.add_arc(node, count, 0));
}

void WalkRelaxation::add_columns(const Task& task) {
  std::vector<double> prizes;
  for (const NodeId node : nodes_) {
    const double prize = task.prize(node);
    prizes.push_back(prize);
    visit_.push_back(program_.add_column(prize, node == task.start() ? 1 : 0, 1));
    const bool may_end = task.ends_anywhere() || node == task.end();
    end_.push_back(may_end ? program_.add_column(0, 0, 1) : -1);
  }
  prize_step_ = common_step(prizes);
  const auto most_uses = static_cast<double>(nodes_.size());  // a way to each first visit uses an arc once at most
  for (Arc& arc : arcs_) {
    const double affordable = arc.cost > 0 ? std::floor(task.limit() / arc.cost + kStepRounding) : most_uses;
    arc.once = program_.add_column(0, 0, directed_ ? std::min(affordable, most_uses) : 1);
    if (!directed_) arc.twice = program_.add_column(0, 0, affordable >= 2 ? 1 : 0);
  }
}

// [n] true where, by parity, no walk that ends there costs exactly `budget` steps. All false unless the graph is
// bipartite by its costs in steps.
std::vector<bool> WalkRelaxation::odd_ends(double step, double budget) const {
  std::vector<int> colour(nodes_.size(), -1);
  std::vector<int> queue = {0};
  colour[0] = 0;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int node = queue[head];
    for (const int i : at_[node]) {
      const int next = arcs_[i].other_end(node);
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
  cost.upper = step > 0 ? std::floor(task.limit() / step) : task.limit();  // with a billionth where sums are not exact
  for (const Arc& arc : arcs_) add_uses(cost, arc, step > 0 ? std::round(arc.cost / step) : arc.cost);
  if (step > 0) {
    const std::vector<bool> odd = odd_ends(step, cost.upper);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (odd[i]) cost.add(end_[i], 1);
    }
  }
  LinearProgram::Row& ends = rows.emplace_back(LinearProgram::Row{.lower = 1, .upper = 1});
  for (const int end : end_) ends.add(end, 1);
  for (int i = 0; i < std::ssize(nodes_); ++i) {
    LinearProgram::Row arrivals{.lower = 0};
    LinearProgram::Row balance{.lower = i == 0 ? -1.0 : 0.0, .upper = i == 0 ? -1.0 : 0.0};
    for (const int arc : at_[i]) {
      if (!directed_ || arcs_[arc].to == i) add_uses(arrivals, arcs_[arc], 1);
      if (directed_) add_uses(balance, arcs_[arc], arcs_[arc].to == i ? 1 : -1);
    }
    (directed_ ? balance : arrivals).add(end_[i], directed_ ? -1 : 1);
    if (directed_) rows.push_back(std::move(balance));
    if (i == 0) continue;
    arrivals.add(visit_[i], directed_ ? -1 : -2);
    rows.push_back(std::move(arrivals));
  }
  program_.add_rows(rows);
  fixed_rows_ = program_.rows();
}

// Adds factor · z(S), S being the nodes for which `inside` says so; with fewer columns as factor · (1 - z(V \ S)).
void WalkRelaxation::add_ends(LinearProgram::Row& row, double factor, const std::vector<char>& inside) const {
  const auto count = std::count_if(inside.begin(), inside.end(), [](char in) { return in != 0; });
  const bool direct = 2 * count <= std::ssize(inside);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if ((inside[i] != 0) == direct) row.add(end_[i], direct ? factor : -factor);
  }
  if (direct) return;
  row.lower -= factor;
  row.upper -= factor;
}

int WalkRelaxation::separate(const Clock& clock) {
  found_.clear();
  separate_simple();
  if (!directed_) separate_parity(clock);
  if (!directed_) separate_partitions();
  separate_connection(clock);
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
    for (const int node : {arc.from, arc.to}) at_most(taken(arc), {arc.once, arc.twice}, visit_[node]);
  }
}

// Of the edges for which `joins` says so, in the order of their first nodes. [n]
std::vector<int> WalkRelaxation::components(const std::function<bool(const Arc&)>& joins) const {
  boost::disjoint_sets_with_storage<> sets(nodes_.size());
  for (const Arc& arc : arcs_) {
    if (joins(arc)) sets.union_set(arc.from, arc.to);
  }
  std::vector<int> number(nodes_.size(), -1);  // by a set's representative
  std::vector<int> component;
  int count = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    int& of_set = number[sets.find_set(i)];
    if (of_set < 0) of_set = count++;
    component.push_back(of_set);
  }
  return component;
}

// Tries partitions into single nodes, and into the components of edges above some value. A minimum cut chooses the
// parts by which the row is violated most: each is worth its y and costs the edges at it. The others join the start's
// part.
void WalkRelaxation::separate_partitions() {
  std::set<std::vector<int>> tried;
  for (const double least : {2.0, 0.99, 0.9, 0.75, 0.6, 0.4}) {
    const std::vector<int> component = components([&](const Arc& arc) { return taken(arc) > least; });
    if (tried.insert(component).second) separate_partition(component);
  }
}

void WalkRelaxation::separate_partition(const std::vector<int>& component) {
  std::vector<int> worth_most(1 + *std::max_element(component.begin(), component.end()), -1);  // node of a part
  for (int i = 0; i < std::ssize(nodes_); ++i) {
    int& best = worth_most[component[i]];
    if (best < 0 || value(visit_[i]) > value(visit_[best])) best = i;
  }
  std::vector<const Arc*> across;
  for (const Arc& arc : arcs_) {
    if (component[arc.from] != component[arc.to]) across.push_back(&arc);
  }
  const int parts = static_cast<int>(worth_most.size());
  const int source = parts + static_cast<int>(across.size());
  MaxFlow choice(source + 2);
  double worth = 0;
  for (int part = 0; part < parts; ++part) {
    if (part == component[0]) continue;
    choice.add_arc(source, part, value(visit_[worth_most[part]]));
    worth += value(visit_[worth_most[part]]);
  }
  for (int i = 0; i < std::ssize(across); ++i) {
    choice.add_arc(parts + i, source + 1, taken(*across[i]));
    for (const int node : {across[i]->from, across[i]->to}) {
      if (component[node] != component[0]) choice.add_arc(component[node], parts + i, kNoLimit);
    }
  }
  const bool holds = choice.reaches(source, source + 1, worth - kViolation);
  scanned_ += choice.scanned();
  if (holds) return;
  std::vector<char> chosen(source + 2);
  for (const int node : choice.near_side()) chosen[node] = 1;
  LinearProgram::Row& row = found_.emplace_back();
  row.lower = 0;
  for (const Arc* const arc : across) {
    if (chosen[component[arc->from]] == 0 && chosen[component[arc->to]] == 0) continue;
    row.add(arc->once, 1);
    row.add(arc->twice, 1);
  }
  for (int part = 0; part < parts; ++part) {
    if (chosen[part] != 0) row.add(visit_[worth_most[part]], -1);
  }
}

// Tries single nodes as S, and the components of edges whose u is farther from a whole number than some fraction.
void WalkRelaxation::separate_parity(const Clock& clock) {
  std::set<std::vector<int>> tried;
  for (const double fraction : {1.0, 0.01, 0.1, 0.2, 0.3, 0.4}) {
    const std::vector<int> component =
        components([&](const Arc& arc) { return from_whole(value(arc.once)) > fraction; });
    if (tried.insert(component).second) separate_parity_of(component);
  }
  if (found_.empty()) separate_parity_cuts(clock);
}

// Takes S from minimum cuts between nodes, where an edge's capacity is the distance of its value from a whole number.
// A cut tree holds a violated row if any exists without ends [Padberg and Rao 1982; Letchford, Reinelt and Theis 2008];
// the cuts come from an equivalent flow tree [Gusfield 1990].
void WalkRelaxation::separate_parity_cuts(const Clock& clock) {
  const int count = static_cast<int>(nodes_.size());
  MaxFlow distances(count);
  const auto add = [&](int one, int other, double part) {
    if (from_whole(part) > kViolation) distances.add_arc(one, other, from_whole(part), from_whole(part));
  };
  for (const Arc& arc : arcs_) add(arc.from, arc.to, value(arc.once));
  for (int i = 1; i < count; ++i) add(i, 0, value(end_[i]));
  const std::vector<int> part = components([&](const Arc& arc) { return from_whole(value(arc.once)) > kViolation; });
  std::vector<int> first(count, -1);
  std::vector<int> toward(count, -1);
  for (int i = 0; i < count; ++i) {
    int& root = first[part[i]];
    if (root >= 0) toward[i] = root;
    if (root < 0) root = i;
  }
  for (int i = 0; i < count; ++i) {
    if (toward[i] < 0) continue;
    if (clock.passed()) break;
    distances.reaches(i, toward[i], kNoLimit);
    std::vector<int> side(count);
    for (const int node : distances.near_side()) side[node] = 1;
    for (int j = i + 1; j < count; ++j) {
      if (side[j] != 0 && toward[j] == toward[i]) toward[j] = i;
    }
    separate_parity_of(side);
  }
  scanned_ += distances.scanned();
}

// Adds the rows violated with S a component. The best F holds the values nearer to 1 than to 0; if their number is
// even, the value nearest to a half changes sides.
void WalkRelaxation::separate_parity_of(const std::vector<int>& component) {
  struct Cut {
    double distance = 0;  // of all values from the nearest whole number
    double flip = 1;      // how much further one of them is from the other, at least
    bool odd = false;     // how many are nearer to 1
    double end = 0;

    void add(double part) {
      distance += from_whole(part);
      flip = std::min(flip, std::abs(1 - 2 * part));
      odd = odd != (part > 0.5);
    }
  };
  std::vector<Cut> cuts(1 + *std::max_element(component.begin(), component.end()));
  for (const Arc& arc : arcs_) {
    if (component[arc.from] == component[arc.to]) continue;
    for (const int node : {arc.from, arc.to}) cuts[component[node]].add(value(arc.once));
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) cuts[component[i]].end += value(end_[i]);
  // Of two parts the cut is the same.
  for (int which = cuts.size() == 2 ? 1 : 0; which < std::ssize(cuts); ++which) {
    Cut& cut = cuts[which];
    cut.add(std::clamp(which == component[0] ? 1 - cut.end : cut.end, 0.0, 1.0));
    if (cut.distance + (cut.odd ? 0 : cut.flip) < 1 - kViolation) add_parity_row(component, which);
  }
}

void WalkRelaxation::add_parity_row(const std::vector<int>& component, int which) {
  struct Term {
    int column;  // -1 for z(S)
    double value;
    bool in_f;
    double flip() const { return std::abs(1 - 2 * value); }
  };
  std::vector<char> inside(nodes_.size());
  double end = 0;
  const bool turned = component[0] == which;  // S is without the start
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    inside[i] = static_cast<char>((component[i] == which) != turned);
    if (inside[i] != 0) end += value(end_[i]);
  }
  std::vector<Term> terms = {{-1, end, end > 0.5}};
  for (const Arc& arc : arcs_) {
    if (inside[arc.from] != inside[arc.to]) terms.push_back({arc.once, value(arc.once), value(arc.once) > 0.5});
  }
  auto size = std::count_if(terms.begin(), terms.end(), [](const Term& term) { return term.in_f; });  // |F|
  if (size % 2 == 0) {
    const auto by_flip = [](const Term& a, const Term& b) { return a.flip() < b.flip(); };
    Term& flipped = *std::min_element(terms.begin(), terms.end(), by_flip);
    flipped.in_f = !flipped.in_f;
    size += flipped.in_f ? 1 : -1;
  }
  // Sum of (1 - value) over F and of value over the others >= 1.
  LinearProgram::Row& row = found_.emplace_back();
  row.lower = 1 - static_cast<double>(size);
  add_ends(row, terms[0].in_f ? -1 : 1, inside);
  for (const Term& term : terms) row.add(term.column, term.in_f ? -1 : 1);
}

// Checks nodes in descending order of y. A node found connected well enough is in no violated S of a later one: it
// counts as the start from then on, which keeps flows short.
void WalkRelaxation::separate_connection(const Clock& clock) {
  const std::int64_t before = network_.scanned();
  for (std::size_t arc = 0; arc < arcs_.size(); ++arc) {
    const double capacity = uses(arcs_[arc]);
    network_.set_capacity(static_cast<int>(2 * arc), capacity, directed_ ? 0 : capacity);
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) network_.set_capacity(to_start_[i], directed_ ? 0 : value(end_[i]));
  network_.set_capacity(to_start_[0], kNoLimit);
  std::vector<int> order(nodes_.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(),
                   [&](int one, int other) { return value(visit_[one]) > value(visit_[other]); });
  std::vector<char> cut_off(nodes_.size());
  for (const int node : order) {
    const double needed = (directed_ ? 1 : 2) * value(visit_[node]) - kViolation;
    if (needed <= 0) break;
    if (cut_off[node] != 0) continue;
    if (clock.passed()) break;
    if (network_.reaches(node, static_cast<int>(nodes_.size()), needed)) {
      network_.set_capacity(to_start_[node], kNoLimit);
      continue;
    }
    add_connection_row(node);
    for (const int other : network_.near_side()) cut_off[other] = 1;
  }
  scanned_ += network_.scanned() - before;
}

void WalkRelaxation::add_connection_row(int node) {
  std::vector<char> inside(nodes_.size());
  for (const int other : network_.near_side()) inside[other] = 1;
  LinearProgram::Row& row = found_.emplace_back();
  row.lower = 0;
  for (const Arc& arc : arcs_) {
    const bool crosses = directed_ ? inside[arc.to] != 0 && inside[arc.from] == 0 : inside[arc.to] != inside[arc.from];
    if (crosses) add_uses(row, arc, 1);
  }
  if (!directed_) add_ends(row, 1, inside);
  row.add(visit_[node], directed_ ? -1 : -2);
}

bool WalkRelaxation::integral() const {
  const auto values = program_.values();
  return std::all_of(values.begin(), values.end(),
                     [](double part) { return std::abs(part - std::round(part)) <= kIntegral; });
}

WalkRelaxation::Branches WalkRelaxation::branches() {
  Branches halves = halve_ends();
  return halves.second.empty() ? split_a_column() : halves;
}

// The walk ends in one half of the nodes or in the other. Empty where the ends are integral. Cuts the nodes, in their
// depth-first order, where the halves' sums of z are most equal.
WalkRelaxation::Branches WalkRelaxation::halve_ends() const {
  std::vector<int> ends;  // columns
  for (const int node : depth_first_) {
    if (end_[node] >= 0 && program_.upper(end_[node]) > 0) ends.push_back(end_[node]);
  }
  double sum = 0;
  double best = kIntegral;
  std::size_t split = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    sum += value(ends[i]);
    if (std::min(sum, 1 - sum) <= best) continue;
    best = std::min(sum, 1 - sum);
    split = i + 1;
  }
  Branches result;
  for (std::size_t i = 0; split > 0 && i < ends.size(); ++i) {
    (i < split ? result.second : result.first).push_back({ends[i], 0, 0});
  }
  return result;
}

// Columns of visits and edges that are least integral, at most kProbed, the least first.
std::vector<int> WalkRelaxation::least_integral_columns() const {
  std::vector<int> columns;
  const auto fraction = [&](int column) { return std::abs(value(column) - std::round(value(column))); };
  const auto add = [&](int column) {
    if (fraction(column) > kIntegral) columns.push_back(column);
  };
  for (const int column : visit_) add(column);
  for (const Arc& arc : arcs_) {
    add(arc.once);
    add(arc.twice);
  }
  std::stable_sort(columns.begin(), columns.end(), [&](int one, int other) { return fraction(one) > fraction(other); });
  if (std::ssize(columns) > kProbed) columns.resize(kProbed);
  return columns;
}

// Rounds a column up in one part and down in the other: the column by which both bounds fall most [strong branching,
// Applegate et al. 1995]. Empty where all are integral.
WalkRelaxation::Branches WalkRelaxation::split_a_column() {
  Branches result;
  const std::vector<int> columns = least_integral_columns();
  if (columns.empty()) return result;
  const double now = program_.bound();
  const auto fall = [&](const Change& change) {
    const double bound = program_.probe(change.column, change.lower, change.upper, kProbeIterations);
    return std::min(kMostFall, now - bound) + kLeastTrialFall;
  };
  double best_score = -1;
  for (const int column : columns) {
    const double down = std::floor(value(column) + kIntegral);
    const Change above = {column, down + 1, program_.upper(column)};
    const Change below = {column, program_.lower(column), down};
    double score = 0;
    if (columns.size() > 1) {
      score = fall(above);
      score *= fall(below);
    }
    if (score <= best_score) continue;
    best_score = score;
    result = {.first = {above}, .second = {below}};
  }
  return result;
}

// An Eulerian trail of the start's component [Hierholzer 1873].
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
    stack.push_back(arc.other_end(node));
  }
  std::reverse(walk.begin(), walk.end());
  return walk;
}

}  // namespace graphdrl
