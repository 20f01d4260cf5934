// Team orienteering problems of Chao, Golden and Wasil.
#pragma once

#include <string>
#include <string_view>

#include "graphdrl/io/node_link.h"

namespace graphdrl {

// Whether a text begins with lines `n …` and `m …` or `tmax …`.
bool is_chao(std::string_view text);

// `n PLACES`, `m TEAM` and `tmax LIMIT`, then a line `X Y SCORE` for each place: a complete graph whose costs are the
// distances, not rounded [Chao, Golden and Wasil 1996]. The walk begins at the first place and ends at the last one;
// LIMIT is its budget, scores are prizes. Throws Error, naming `source` and the line, on anything else, and on a team
// of more than one. Cost: O(N²).
GraphMap parse_chao(std::string_view text, const std::string& source, const MapOptions& options = {});

}  // namespace graphdrl
