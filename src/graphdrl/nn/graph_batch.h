// Several graphs, of any sizes, laid end to end: the unit that networks work on.
//
// Legend for all shapes in nn/ and train/: B graphs, N nodes of all graphs together, F input features, D width of a
// layer, L propagation steps, A actions. Matrices are row-major.
#pragma once

#include <cstddef>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// A row of [rows, width].
template <typename T>
T* row_of(T* values, int row, int width) {
  return values + static_cast<std::ptrdiff_t>(row) * width;
}

// The graphs are not copied and must outlive the batch; one graph may stand in it many times.
class GraphBatch {
 public:
  void clear() {
    graphs_.clear();
    offsets_.assign(1, 0);
  }
  void add(const Graph& graph) {
    graphs_.push_back(&graph);
    offsets_.push_back(offsets_.back() + graph.node_count());
  }

  int graph_count() const { return static_cast<int>(graphs_.size()); }  // B
  int node_count() const { return offsets_.back(); }                    // N
  const Graph& graph(int index) const { return *graphs_[index]; }
  int first_node(int index) const { return offsets_[index]; }  // row of graph `index`'s node 0; N for index B

 private:
  std::vector<const Graph*> graphs_;
  std::vector<int> offsets_ = {0};  // [B + 1]
};

}  // namespace graphdrl
