// Models of GraphWalker as testers run them: elements with ids and names, a generator, a stop condition.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graphdrl/graph/graph.h"

namespace graphdrl {

// When a walk may end: one of several lists of terms, all of which must hold.
struct StopCondition {
  enum class Kind { kEdgeCoverage, kVertexCoverage, kLength, kTimeDuration, kReachedVertex, kReachedEdge, kNever };
  struct Term {
    Kind kind = Kind::kNever;
    double value = 0;       // percent, steps from vertex to vertex, seconds
    std::string name = {};  // of an element to reach
  };
  std::vector<std::vector<Term>> any_of;
};

// What a model asks for: "random(edge_coverage(100))". `random`, `quick_random` and `weighted_random` are the same to
// us: the walk is planned. Throws Error, naming it, on another generator or condition.
struct WalkGenerator {
  std::string name;
  StopCondition stop;
};
WalkGenerator parse_walk_generator(std::string_view text);

struct WalkerModel {
  struct Element {
    std::string id;
    std::string name;        // may be empty
    std::string properties;  // a JSON object
  };
  std::string name;
  WalkGenerator generator;
  std::vector<Element> vertices;
  std::vector<Element> edges;
  std::vector<Edge> ends;  // [edges]; a: kNoNode for an edge from nowhere. A weight is no cost
  // Where a walk begins: an edge, or else a vertex.
  int start_edge = -1;
  NodeId start_vertex = kNoNode;
};

// All models of a document {"models": […]}. generator: of all of them, instead of their own; empty for their own.
// Throws Error on what is no model, and, naming the element, on guards, actions and shared states, which we do not run.
std::vector<WalkerModel> parse_walker_models(std::string_view text, const std::string& source,
                                             std::string_view generator = {});

}  // namespace graphdrl
