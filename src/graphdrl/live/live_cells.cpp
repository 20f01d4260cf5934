#include "graphdrl/live/live_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_map>
#include <utility>

#include "graphdrl/live/live_states.h"

namespace graphdrl {

LiveCells::LiveCells(const LiveOptions& options)
    : score_(options.score.value_or(Score::kSeen)), graph_(options.connectivity, score_) {
  const auto refuse = [](const char* field, const char* what) { throw FieldError(field, {.what = what}); };
  if (options.cover == Cover::kEdges) refuse("cover", "of cells there are no edges to cover");
  if (options.reset_cost) refuse("reset_cost", "a robot cannot be put back to where it began");
}

std::string LiveCells::default_policy() const {
  return score_ == Score::kSeen ? kSeeingPolicy : kOnlinePolicy;
}

std::unique_ptr<Policy> LiveCells::own_policy(const std::string& name) {
  if (name == kNovelty) throw FieldError("policy", {.what = "this policy is for states", .got = in_quotes(name)});
  return nullptr;
}

void LiveCells::check(const LiveObservation& seen) const {
  if (!seen.state.empty()) throw FieldError("state", {.what = "the exploration is one of cells"});
  if (seen.moves) throw FieldError("moves", {.what = "the exploration is one of cells"});
  if (!seen.at) throw FieldError("at", {.what = "a message says where the robot is"});
  if (!std::isfinite(seen.at->x) || !std::isfinite(seen.at->y)) {
    throw FieldError("at", {.what = "a coordinate is not finite"});
  }
  if (seen.failed && way_.empty()) throw FieldError("failed", {.what = "nothing was asked for that could fail"});
  if (!seen.cells && here_ == kNoNode) throw FieldError("cells", {.what = "the first message has the cells around"});
  if (seen.cells) {
    if (std::string fault = graph_.fault(*seen.cells); !fault.empty()) {
      throw FieldError("cells", {.what = std::move(fault)});
    }
  }
  if (!graph_.standing_at(*seen.at, seen.cells ? &*seen.cells : nullptr)) {
    throw FieldError("at", {.what = "no free cell is near",
                            .got = fmt::format("[{}, {}]", decimal(seen.at->x), decimal(seen.at->y))});
  }
}

double LiveCells::cost_between(NodeId from, NodeId to) const {
  return length_between(graph_.centre(from), graph_.centre(to));
}

// How it has come to a node: along what it was told, else the cheapest way known, else straight.
std::vector<NodeId> LiveCells::way_to(NodeId node, const std::vector<NodeId>& told) {
  if (node == here_) return {};
  if (const auto met = std::ranges::find(told, node); met != told.end()) {
    bool is_there = true;  // what was told is still a way
    for (auto next = told.begin(); next <= met; ++next) {
      const NodeId before = next == told.begin() ? here_ : *(next - 1);
      is_there = is_there && graph_.view().open().index_of(before, *next) >= 0;
    }
    if (is_there) return {told.begin(), met + 1};
  }
  bool found = false;
  if (here_ != kNoNode) {
    search_.run(graph_.view().open(), here_, kNoLimit, [&](NodeId next, double) {
      found = next == node;
      return found ? NearestFirst::Next::kEnd : NearestFirst::Next::kThrough;
    });
  }
  std::vector<NodeId> way;
  if (found) {
    search_.append_path_to(node, way);
  } else {
    way.push_back(node);
  }
  return way;
}

LiveMap::Moved LiveCells::take(const LiveObservation& seen) {
  graph_.begin_visit();
  const std::vector<NodeId> told = std::exchange(way_, {});
  if (seen.cells) graph_.add(*seen.cells);
  at_ = *seen.at;
  const NodeId node = graph_.stand_in(*graph_.standing_at(at_, nullptr));
  Moved moved{.way = way_to(node, told)};
  double cost = 0;
  for (NodeId before = here_; const NodeId next : moved.way) {
    if (before != kNoNode) cost += cost_between(before, next);
    before = next;
    graph_.visit(next);
  }
  here_ = node;
  moved.cost = seen.cost.value_or(cost);
  if (!told.empty()) ++steps_;
  if (moved.cost != cost) graph_.change();  // policies counted on other sums
  if (seen.failed) graph_.failed(told.back());
  return moved;
}

LiveStep LiveCells::tell(std::span<const NodeId> way) {
  way_.assign(way.begin(), way.end());
  LiveStep step{.kind = LiveStep::Kind::kGoto};
  for (const NodeId node : way) step.way.push_back(graph_.centre(node));
  return step;
}

void LiveCells::told(const LiveStep& step) {
  if (step.kind != LiveStep::Kind::kGoto || step.way.empty()) throw Error({.what = "cells have no moves"});
  std::vector<NodeId> way;
  for (const Point& point : step.way) {
    way.push_back(graph_.node_at(point));
    if (way.back() == kNoNode) throw Error({.what = "a way leads through what is not free"});
  }
  way_ = std::move(way);
}

void LiveCells::add_to(LiveReport& report) const {
  report.steps = steps_;
  LiveCellReport& cells = report.cells.emplace();
  cells.at = at_;
  cells.seen = graph_.free_count();
  cells.visited = graph_.visited_count();
  cells.left = graph_.left_count();
  cells.changed = graph_.changes();
  for (const auto& [cell, one] : graph_.failures()) {
    cells.failed.push_back({.goal = graph_.centre(one.goal), .failures = one.failures});
  }
}

// Where it was not known how the robot came from a cell to the next, it is drawn as if it had gone straight.
LiveMap::Picture LiveCells::picture(const std::string& name, std::span<const NodeId> walk,
                                    std::span<const int> seen_after) const {
  GridMap map = graph_.picture();
  const double side = map.frame->cell_size;
  std::vector<NodeId> drawn;
  std::vector<int> after;
  const auto enter = [&](const Cell& cell, int seen) {
    const NodeId node = graph_.in_map(cell);
    map.blocked[node] = false;
    drawn.push_back(node);
    after.push_back(seen);
  };
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const Cell to = graph_.cell(walk[i]);
    if (i > 0) {
      Cell at = graph_.cell(walk[i - 1]);
      const Cell from = at;
      const Cell whole = {to.row - from.row, to.col - from.col};
      const int steps = std::max(std::abs(whole.row), std::abs(whole.col));
      for (int step = 1; step <= steps; ++step) {
        const Cell next = {from.row + static_cast<int>(std::lround(static_cast<double>(whole.row) * step / steps)),
                           from.col + static_cast<int>(std::lround(static_cast<double>(whole.col) * step / steps))};
        const bool corner = !map.diagonals && next.row != at.row && next.col != at.col;
        if (corner) enter({at.row, next.col}, seen_after[i - 1]);
        if (next != to) enter(next, seen_after[i - 1]);
        at = next;
      }
    }
    enter(to, seen_after[i]);
  }
  Picture picture{.world = World(name, std::move(map)),
                  .plan = {},
                  .seen = {},
                  .after = std::move(after),
                  .reveal = Reveal::parse("sight:inf"),
                  .score = score_,
                  .unit = side};
  for (NodeId node = 0; node < seen_count(); ++node) picture.seen.push_back(graph_.in_map(graph_.cell(node)));
  picture.plan.walk = std::move(drawn);
  picture.plan.visited = graph_.visited_count();
  picture.plan.prize = score_ == Score::kSeen ? graph_.free_count() : graph_.visited_count();
  return picture;
}

}  // namespace graphdrl
