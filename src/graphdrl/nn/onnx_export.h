// The networks as ONNX models [onnx.ai], for other runtimes: opset 16, any number of graphs of any sizes in one call.
//
// Graphs are given as PyTorch Geometric gives them: edge_index [2, E], int64, row 0 the sources and row 1 the targets,
// an undirected edge both ways; batch [N], int64, the graph of each node, from 0 up.
#pragma once

#include <filesystem>

#include "graphdrl/nn/explorer_network.h"
#include "graphdrl/nn/paper_network.h"

namespace graphdrl {

// Inputs: x [N, 7], edge_index, batch. Output: q [B, 4], as PaperNetwork::q_values(). Throws Error where the file
// cannot be written.
void write_onnx(const std::filesystem::path& path, const PaperParameters& parameters);

// Inputs: node_x [N, 20], edge_index, batch; current [B], visit_x [C, 11], target [C] and state [C], as in
// ExplorerBatch, integers as int64. Output: shortfall [C], as ExplorerNetwork::forward(). Throws likewise.
void write_onnx(const std::filesystem::path& path, const ExplorerParameters& parameters);

}  // namespace graphdrl
