// The models of GraphWalker, which tests are made from.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text is a JSON object with models that have vertices.
bool is_graph_walker(std::string_view text);

// One model [graphwalker.github.io/json-files]: a directed graph. Vertices go by their names where these are all
// different, else by their ids; `properties` may hold x and y. The model's startElementId, or else its only edge from
// nowhere, names the start. A `weight` there is a probability: edges cost 1, unless the options name an attribute.
// Throws Error, naming `source` and the place, on anything else.
GraphMap parse_graph_walker(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
