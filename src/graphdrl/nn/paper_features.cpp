#include "graphdrl/nn/paper_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

float& at(std::span<float> matrix, NodeId node, PaperFeature feature) {
  return matrix[static_cast<std::size_t>(node) * kPaperFeatureCount + static_cast<std::size_t>(feature)];
}

bool is_wall(PaperWall wall, const GridMap& map, Cell cell) {
  const Cell last = wall == PaperWall::kBorder ? Cell{map.rows - 1, map.cols - 1} : Cell{9, 9};
  return cell.row == 0 || cell.col == 0 || cell.row == last.row || cell.col == last.col;
}

}  // namespace

std::string_view name_of(PaperWall wall) {
  return kPaperWallNames[static_cast<std::size_t>(wall)];
}

PaperWall parse_paper_wall(std::string_view name, const std::string& source) {
  const auto* const found = std::find(kPaperWallNames.begin(), kPaperWallNames.end(), name);
  if (found == kPaperWallNames.end()) {
    throw Error({.what = "unknown kind of the feature 'wall'",
                 .expected = fmt::format("{}", fmt::join(kPaperWallNames, " or ")),
                 .got = in_quotes(name),
                 .where = source});
  }
  return static_cast<PaperWall>(found - kPaperWallNames.begin());
}

PaperFeatureEncoder::PaperFeatureEncoder(const View& view, PaperWall wall) : view_(view) {
  if (!view.is_grid()) {
    throw Error({.what = "the paper's features need a grid map", .where = view.name()});
  }
  const GridMap& map = view.grid().map();
  untouched_.resize(static_cast<std::size_t>(view.node_count()) * kPaperFeatureCount);
  for (NodeId node = 0; node < view.node_count(); ++node) {
    const Cell cell = map.cell(node);
    at(untouched_, node, PaperFeature::kX) = static_cast<float>(cell.row);
    at(untouched_, node, PaperFeature::kY) = static_cast<float>(cell.col);
    at(untouched_, node, PaperFeature::kObstacle) = view.is_blocked(node) ? 1.0f : 0.0f;
    at(untouched_, node, PaperFeature::kWall) = is_wall(wall, map, cell) ? 1.0f : 0.0f;
    at(untouched_, node, PaperFeature::kUnvisitedNeighbours) = static_cast<float>(view.grid().graph().degree(node));
  }
}

void PaperFeatureEncoder::mark_visited(NodeId node, std::span<float> out) const {
  for (const NodeId next : view_.grid().graph().neighbours(node))
    at(out, next, PaperFeature::kUnvisitedNeighbours) -= 1.0f;
}

template <typename Count>
void PaperFeatureEncoder::encode(NodeId position, std::span<const Count> visits, std::span<float> out) const {
  std::copy(untouched_.begin(), untouched_.end(), out.begin());
  for (const NodeId node : view_.valid_nodes()) {
    if (visits[node] == 0) continue;
    at(out, node, PaperFeature::kVisits) = static_cast<float>(visits[node]);
    mark_visited(node, out);
  }
  at(out, position, PaperFeature::kCurrent) = 1.0f;
}

template void PaperFeatureEncoder::encode(NodeId, std::span<const std::uint16_t>, std::span<float>) const;
template void PaperFeatureEncoder::encode(NodeId, std::span<const std::uint32_t>, std::span<float>) const;

void PaperFeatureEncoder::begin(NodeId start, std::span<float> out) const {
  std::copy(untouched_.begin(), untouched_.end(), out.begin());
  at(out, start, PaperFeature::kVisits) = 1.0f;
  at(out, start, PaperFeature::kCurrent) = 1.0f;
  mark_visited(start, out);
}

void PaperFeatureEncoder::update(NodeId from, NodeId to, const StepResult& step, std::span<float> out) const {
  at(out, from, PaperFeature::kCurrent) = 0.0f;
  at(out, to, PaperFeature::kCurrent) = 1.0f;
  at(out, to, PaperFeature::kVisits) += 1.0f;
  if (step.first_visit) mark_visited(to, out);
}

}  // namespace graphdrl
