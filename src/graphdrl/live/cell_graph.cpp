#include "graphdrl/live/cell_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace graphdrl {
namespace {

// Whether a patch says something of one of its cells: likely to be blocked or free.
bool says_free(std::int8_t value) {
  return value >= 0 && value <= CellGraph::kFree;
}
bool says_blocked(std::int8_t value) {
  return value >= CellGraph::kBlocked;
}

}  // namespace

CellGraph::CellGraph(int connectivity, Score score)
    : connectivity_(connectivity), score_(score), discovery_("live", EdgeKind::kUndirected, true) {}

std::optional<Cell> CellGraph::Grid::cell_at(const Point& point) const {
  const double col = std::floor((point.x - origin.x) / resolution);
  const double up = std::floor((point.y - origin.y) / resolution);
  if (!(std::abs(col) <= kFarthest && std::abs(up) <= kFarthest)) return std::nullopt;
  return Cell{-static_cast<int>(up), static_cast<int>(col)};
}

Point CellGraph::centre(const Cell& cell) const {
  // Sums of decimals are rounded, so that they are told as people write them.
  const auto at = [&](double from, int cells) {
    constexpr double kDigits = 1e9;
    const double exact = from + (cells + 0.5) * grid_->resolution;
    return std::abs(exact) < 1e6 ? std::round(exact * kDigits) / kDigits : exact;
  };
  return {at(grid_->origin.x, cell.col), at(grid_->origin.y, -cell.row)};
}

namespace {

std::uint64_t chunk_of(const Cell& cell, int side) {
  const auto index = [&](int at) { return static_cast<std::uint32_t>(at >= 0 ? at / side : ~(~at / side)); };
  return static_cast<std::uint64_t>(index(cell.row)) << 32 | index(cell.col);
}

std::size_t place_in_chunk(const Cell& cell, int side) {
  const auto rest = [&](int at) { return static_cast<std::size_t>(at >= 0 ? at % side : side - 1 - ~at % side); };
  return rest(cell.row) * static_cast<std::size_t>(side) + rest(cell.col);
}

}  // namespace

std::int32_t CellGraph::value(const Cell& cell) const {
  const auto found = chunks_.find(chunk_of(cell, kChunk));
  return found == chunks_.end() ? kUnknownCell : found->second[place_in_chunk(cell, kChunk)];
}

std::int32_t& CellGraph::value(const Cell& cell) {
  Chunk& chunk = chunks_[chunk_of(cell, kChunk)];
  if (chunk.empty()) chunk.assign(static_cast<std::size_t>(kChunk) * kChunk, kUnknownCell);
  return chunk[place_in_chunk(cell, kChunk)];
}

NodeId CellGraph::node_at(const Point& point) const {
  const std::optional<Cell> cell = grid_ ? grid_->cell_at(point) : std::nullopt;
  return cell && is_free(*cell) ? value(*cell) : kNoNode;
}

bool CellGraph::fits(const Cell& first, const Cell& last) const {
  const bool none = last_.col < first_.col;
  const auto extent = [&](int low, int high, int known_low, int known_high) {
    if (!none) low = std::min(low, known_low);
    if (!none) high = std::max(high, known_high);
    return static_cast<std::int64_t>(high) - low + 1;
  };
  return extent(first.row, last.row, first_.row, last_.row) * extent(first.col, last.col, first_.col, last_.col) <=
         kMostCells;
}

void CellGraph::reach(const Cell& cell) {
  const bool none = last_.col < first_.col;
  first_ = none ? cell : Cell{std::min(first_.row, cell.row), std::min(first_.col, cell.col)};
  last_ = none ? cell : Cell{std::max(last_.row, cell.row), std::max(last_.col, cell.col)};
}

std::string CellGraph::fault(const CellPatch& patch) const {
  if (!(patch.resolution >= 1e-9 && patch.resolution <= 1e9)) return "the resolution is not from 1e-9 to 1e9";
  if (patch.width < 1 || patch.height < 1) return "there are no cells";
  if (static_cast<std::int64_t>(patch.width) * patch.height != std::ssize(patch.data)) {
    return fmt::format("{} values for {} × {} cells", patch.data.size(), patch.width, patch.height);
  }
  constexpr double kOff = 0.1;  // of a cell
  const Grid grid = grid_.value_or(Grid{patch.origin, patch.resolution});
  if (std::abs(patch.resolution / grid.resolution - 1) * std::max(patch.width, patch.height) > kOff) {
    return fmt::format("the resolution was {}", grid.resolution);
  }
  for (const double off : {patch.origin.x - grid.origin.x, patch.origin.y - grid.origin.y}) {
    const double cells = off / grid.resolution;
    if (!(std::abs(cells) <= kFarthest)) return "the origin is too far off";
    if (std::abs(cells - std::round(cells)) > kOff) return "the origin lies between the cells told before";
  }
  const Cell low = *grid.cell_at({patch.origin.x + grid.resolution / 2, patch.origin.y + grid.resolution / 2});
  if (!fits({low.row - patch.height + 1, low.col}, {low.row, low.col + patch.width - 1})) {
    return fmt::format("a rectangle around all cells has more than {}", kMostCells);
  }
  return "";
}

void CellGraph::change() {
  if (!changed_now_) discovery_.begin_visit();
  changed_now_ = true;
}

void CellGraph::set_free(const Cell& cell) {
  change();
  reach(cell);
  std::int32_t& here = value(cell);
  ++free_count_;
  if (here != kUnknownCell) ++changes_;
  if (here <= kBlockedNode) {
    here = kBlockedNode - here;
    return discovery_.see_again(here);
  }
  here = discovery_.see({.place = centre(cell)});
  cells_.push_back(cell);
  visited_.push_back(false);
  ground_.grow(here + 1);
}

void CellGraph::set_blocked(const Cell& cell) {
  change();
  reach(cell);
  std::int32_t& here = value(cell);
  if (here < 0) {
    here = kBlockedCell;
    return;
  }
  here = kBlockedNode - here;
  ++changes_;
  --free_count_;
}

void CellGraph::add(const CellPatch& patch) {
  if (!grid_) grid_ = Grid{patch.origin, patch.resolution};
  const double half = grid_->resolution / 2;
  const Cell low = *grid_->cell_at({patch.origin.x + half, patch.origin.y + half});
  std::vector<Cell> changed;
  for (int up = patch.height - 1; up >= 0; --up) {  // as a map's rows go
    for (int right = 0; right < patch.width; ++right) {
      const std::int8_t said = patch.data[static_cast<std::size_t>(up) * patch.width + right];
      if (!says_free(said) && !says_blocked(said)) continue;
      const Cell cell = {low.row - up, low.col + right};
      const std::int32_t before = std::as_const(*this).value(cell);
      if (says_free(said) ? before >= 0 : before <= kBlockedCell) continue;
      if (says_free(said)) {
        set_free(cell);
      } else {
        set_blocked(cell);
      }
      changed.push_back(cell);
    }
  }
  settle(changed);
}

// Whether a step from a free cell leads to a free one.
bool CellGraph::joins(const Cell& from, const Cell& step) const {
  if (!is_free(from + step)) return false;
  return step.row == 0 || step.col == 0 || (is_free(from + Cell{step.row, 0}) && is_free(from + Cell{0, step.col}));
}

bool CellGraph::has_unknown_beside(const Cell& cell) const {
  return std::any_of(kGridSteps.begin(), kGridSteps.begin() + kDirectionCount,
                     [&](const Cell& step) { return value(cell + step) == kUnknownCell; });
}

// Neighbours are in the order of the steps.
void CellGraph::connect_around(NodeId node) {
  const Graph& open = view().open();
  const auto place_of = [&](NodeId from, const Cell& step) {
    int place = 0;
    for (const Cell& before : kGridSteps) {
      if (before == step) break;
      const std::int32_t to = std::as_const(*this).value(cells_[from] + before);
      place += to >= 0 && open.index_of(from, to) >= 0;
    }
    return place;
  };
  for (int i = 0; i < connectivity_; ++i) {
    const Cell& step = kGridSteps[i];
    if (!joins(cells_[node], step)) continue;
    const NodeId to = std::as_const(*this).value(cells_[node] + step);
    if (open.index_of(node, to) >= 0) continue;
    const double cost = grid_->resolution * std::hypot(step.row, step.col);
    discovery_.connect({node, to, cost}, {.of_b = place_of(node, step), .of_a = place_of(to, {-step.row, -step.col})});
  }
}

// The edges, frontier and ground around cells that have changed.
void CellGraph::settle(const std::vector<Cell>& changed) {
  std::vector<NodeId> touched;
  std::vector<NodeId> gone;
  for (const Cell& cell : changed) {
    const std::int32_t here = std::as_const(*this).value(cell);
    if (here <= kBlockedNode) gone.push_back(kBlockedNode - here);
    for (int row = -1; row <= 1; ++row) {
      for (int col = -1; col <= 1; ++col) {
        const std::int32_t near = std::as_const(*this).value(cell + Cell{row, col});
        if (near >= 0) touched.push_back(near);
      }
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const Graph& open = view().open();
  std::vector<std::pair<NodeId, NodeId>> apart;
  for (const NodeId node : gone) {
    for (const NodeId next : open.neighbours(node)) {
      if (!blocked(next) || node < next) apart.emplace_back(node, next);
    }
  }
  for (const NodeId node : touched) {
    for (const NodeId next : open.neighbours(node)) {
      const Cell step = {cells_[next].row - cells_[node].row, cells_[next].col - cells_[node].col};
      if (node < next && !blocked(next) && !joins(cells_[node], step)) apart.emplace_back(node, next);
    }
  }
  discovery_.disconnect(apart);
  for (const NodeId node : gone) {
    discovery_.forget(node);
    ground_.insert(node);
  }
  for (const NodeId node : touched) connect_around(node);
  for (const NodeId node : touched) {
    if (!has_unknown_beside(cells_[node])) discovery_.close(node);
    settle_ground(node);
  }
}

bool CellGraph::is_left(NodeId node) const {
  return !visited_[node] && !blocked(node) && (score_ == Score::kVisited || view().is_frontier(node));
}

template <typename Holds>
const CellGraph::Failure* CellGraph::failure_near(const Cell& cell, const Holds& holds) const {
  for (int row = cell.row - kFailsAround; row <= cell.row + kFailsAround && !failures_.empty(); ++row) {
    auto one = failures_.lower_bound({row, cell.col - kFailsAround});
    for (; one != failures_.end() && one->first <= std::pair(row, cell.col + kFailsAround); ++one) {
      if (holds(one->second)) return &one->second;
    }
  }
  return nullptr;
}

bool CellGraph::is_put_off(const Cell& cell) const {
  const auto holds = [](const Failure& one) { return one.waiting || one.failures >= kMostFailures; };
  return failure_near(cell, holds) != nullptr;
}

void CellGraph::settle_ground(NodeId node) {
  if (is_left(node) && !is_put_off(cells_[node])) {
    ground_.erase(node);
  } else {
    ground_.insert(node);
  }
}

void CellGraph::settle_ground_around(const Cell& cell) {
  for (int row = -kFailsAround; row <= kFailsAround; ++row) {
    for (int col = -kFailsAround; col <= kFailsAround; ++col) {
      const std::int32_t near = std::as_const(*this).value(cell + Cell{row, col});
      if (near >= 0) settle_ground(near);
    }
  }
}

int CellGraph::left_count() const {
  int count = 0;
  for (NodeId node = 0; node < view().node_count(); ++node) count += is_left(node);
  return count;
}

std::optional<Cell> CellGraph::standing_at(const Point& point, const CellPatch* patch) const {
  const Grid grid = grid_ ? *grid_ : Grid{patch->origin, patch->resolution};
  const std::optional<Cell> here = grid.cell_at(point);
  if (!here || !fits(*here, *here)) return std::nullopt;
  std::optional<Cell> low;
  if (patch != nullptr) {
    low = grid.cell_at({patch->origin.x + grid.resolution / 2, patch->origin.y + grid.resolution / 2});
    const Cell& first = {low->row - patch->height + 1, low->col};
    const Cell& last = {low->row, low->col + patch->width - 1};
    if (!fits({std::min(first.row, here->row), std::min(first.col, here->col)},
              {std::max(last.row, here->row), std::max(last.col, here->col)})) {
      return std::nullopt;
    }
  }
  const auto is_blocked = [&](const Cell& cell, bool unknown) {
    std::int8_t said = -1;
    if (low) {
      const int up = low->row - cell.row;
      const int right = cell.col - low->col;
      if (up >= 0 && up < patch->height && right >= 0 && right < patch->width) {
        said = patch->data[static_cast<std::size_t>(up) * patch->width + right];
      }
    }
    if (says_free(said) || says_blocked(said)) return says_blocked(said);
    const std::int32_t known = value(cell);
    return known <= kBlockedCell || (known == kUnknownCell && unknown);
  };
  if (!is_blocked(*here, false)) return here;
  std::optional<Cell> best;
  int least = 0;
  for (int around = 1; around <= kStandsAround && !best; ++around) {
    for (int row = -around; row <= around; ++row) {
      for (int col = -around; col <= around; col += std::abs(row) == around ? 1 : 2 * around) {
        const int distance = row * row + col * col;
        const Cell cell = *here + Cell{row, col};
        if (is_blocked(cell, true) || (best && distance >= least)) continue;
        best = cell;
        least = distance;
      }
    }
  }
  return best;
}

NodeId CellGraph::stand_in(const Cell& cell) {
  if (!is_free(cell)) {
    set_free(cell);
    settle({cell});
  }
  return value(cell);
}

void CellGraph::visit(NodeId node) {
  if (failures_.erase({cells_[node].row, cells_[node].col}) > 0) {
    change();
    settle_ground_around(cells_[node]);
  }
  if (visited_[node]) return;
  visited_[node] = true;
  ++visited_count_;
  change();
  settle_ground(node);
}

void CellGraph::failed(NodeId goal) {
  change();
  // Goals at the frontier that are near each other count as one.
  const Cell& cell = cells_[goal];
  const Failure* const before =
      failure_near(cell, [&](const Failure& one) { return one.goal == goal || (is_left(goal) && is_left(one.goal)); });
  const Cell& counted = before == nullptr ? cell : cells_[before->goal];
  Failure& one = failures_[{counted.row, counted.col}];
  if (before == nullptr) one.goal = goal;
  ++one.failures;
  one.waiting = true;
  settle_ground_around(counted);
}

bool CellGraph::given_up(NodeId goal) const {
  const auto found = failures_.find({cells_[goal].row, cells_[goal].col});
  return found != failures_.end() && found->second.failures >= kMostFailures;
}

bool CellGraph::retry() {
  bool any = false;
  changed_now_ = false;  // a policy that has seen all this and stopped must think again
  for (auto& [cell, one] : failures_) {
    if (!one.waiting || one.failures >= kMostFailures) continue;
    one.waiting = false;
    any = true;
  }
  if (!any) return false;
  change();
  for (const auto& [cell, one] : failures_) settle_ground_around(cells_[one.goal]);
  return true;
}

GridMap CellGraph::map() const {
  GridMap map{.rows = last_.row - first_.row + 1, .cols = last_.col - first_.col + 1, .blocked = {}};
  map.blocked.assign(static_cast<std::size_t>(map.rows) * map.cols, true);
  for (NodeId node = 0; node < view().node_count(); ++node) map.blocked[in_map(cells_[node])] = blocked(node);
  map.diagonals = connectivity_ == 8;
  const Point corner = centre(Cell{last_.row, first_.col});
  const double half = grid_->resolution / 2;
  map.frame = GridFrame{.cell_size = grid_->resolution, .origin = {corner.x - half, corner.y - half}, .unit = "m"};
  return map;
}

GridMap CellGraph::picture() const {
  GridMap map = this->map();
  map.cut_corners = map.diagonals;
  for (NodeId node = 0; node < view().node_count(); ++node) {
    const Cell& cell = cells_[node];
    if (visited_[node]) map.blocked[in_map(cell)] = false;
    if (blocked(node)) continue;
    for (const Cell& step : kGridSteps) {
      const Cell beside = cell + step;
      const bool inside =
          beside.row >= first_.row && beside.row <= last_.row && beside.col >= first_.col && beside.col <= last_.col;
      if (inside && value(beside) == kUnknownCell) map.blocked[in_map(beside)] = false;
    }
  }
  return map;
}

}  // namespace graphdrl
