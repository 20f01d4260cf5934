#include "graphdrl/planners/online_explorer.h"

#include <algorithm>

#include "graphdrl/base/error.h"

namespace graphdrl {

SharedOnlineExplorer builtin_online_explorer() {
  static const SharedOnlineExplorer explorer = std::make_shared<const OnlineParameters>(read_online_explorer(
      Safetensors::parse(std::string(builtin_online_explorer_file()), "the policy in the program")));
  return explorer;
}

NodeId OnlineExplorerPolicy::choose(const Exploration& now, const Observation& observation) {
  if (!now.view().grows()) {
    throw Error({.what = "this policy explores maps that are not known",
                 .expected = "graphdrl explore, or evaluate --reveal",
                 .where = now.view().name()});
  }
  if (now.view().ordered()) return now.nearest_first_visit(search()).node;
  rows_.clear();
  const auto visits = encode_online(now, observation.task->budget(), observation.spent, scratch_, search(), rows_);
  if (visits.empty()) return kNoNode;
  score_.resize(visits.size());
  network_.forward(*parameters_, rows_, score_);
  return visits[std::ranges::max_element(score_) - score_.begin()].node;
}

}  // namespace graphdrl
