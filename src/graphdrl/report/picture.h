// Pictures of any world, and of a walk on it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/env/world.h"
#include "graphdrl/report/canvas.h"
#include "graphdrl/report/fog.h"

namespace graphdrl {

// The step at which each node was first visited; -1 if never. [N]
std::vector<int> first_visits(const World& world, std::span<const NodeId> walk);

// A grid of many cells is drawn as cells, in one bitmap. Other worlds are drawn as nodes and edges, at their places or
// laid out [report/layout.h]. The walk's colour goes from dark to light with time. Its start is a ring, its end an
// arrow head. When it takes an edge again, it is drawn beside the first time. Nodes never visited are marked. What a
// walk that explores has never seen is faint; in a moving picture it is so until it is seen.
class Picture {
 public:
  // The walk is valid or empty. title: a line above; notes: lines below.
  Picture(const World& world, std::span<const NodeId> walk, std::string title, std::vector<std::string> notes,
          Fog fog = {});

  std::string svg() const;
  // A moving picture, which draws the walk step by step.
  std::string moving_svg() const;
  std::string png() const;
  Bitmap pixels() const;

 private:
  void place_cells();
  void place_nodes();
  double height() const;
  std::string description() const;
  std::string drawn_on(Canvas& canvas) const;
  void draw(Canvas& canvas) const;
  void draw_cells(Canvas& canvas) const;
  void draw_fog_of_cells(Canvas& canvas) const;
  void draw_edges(Canvas& canvas) const;
  void draw_nodes(Canvas& canvas) const;
  void draw_walk(Canvas& canvas) const;
  void draw_arrow_head(Canvas& canvas, Point from, Point to) const;
  void draw_legend(Canvas& canvas) const;
  Colour colour_at(std::size_t step) const;
  std::size_t part_at(int step) const;

  World world_;
  std::vector<NodeId> walk_;
  std::string title_;
  std::vector<std::string> notes_;
  Fog fog_;
  std::vector<int> first_visits_;  // [N], steps; -1: never visited
  bool cells_ = false;             // drawn as cells
  double spacing_ = 1;             // pixels between neighbours, roughly
  double width_ = 0;
  double map_bottom_ = 0;
  std::vector<Point> places_;  // [N], of centres
};

}  // namespace graphdrl
