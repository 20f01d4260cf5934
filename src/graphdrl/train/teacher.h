// What first visits are worth by local search [planners/annealing.h].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/env/exploration.h"
#include "graphdrl/env/task.h"
#include "graphdrl/planners/annealing.h"

namespace graphdrl {

// Of one walk. It carries along the best way known to go on, so that each search begins with what the last one found.
class Teacher {
 public:
  // steps: of a search for one label, for each node that is left to visit.
  // REQUIRES: steps > 0; no more nodes than Targets have a table for.
  Teacher(int steps, std::uint64_t seed) : steps_(steps), rng_(seed) {}

  // Searches for the best walk from the beginning.
  void begin(const Task& task);
  // The same from where the walk is now, for less time.
  void look(const Task& task);
  // The walk went on to a node.
  void visited(NodeId node) { std::erase(best_, node); }

  // The first node that the best walk known visits from here; kNoNode where there is none.
  NodeId next_visit(const Task& task);

  // How good the best walk known is that begins with a first visit: as many nodes as it visits, less kWorthOfCost for
  // every mean edge that it costs beyond one a node. REQUIRES: look(task) came before.
  double value(const Task& task, const FirstVisit& first);

 private:
  // Begins with what the best walk makes for, as far as it can be paid for. share: of the steps of a label's search.
  Tour improve(const Targets& targets, double limit, double share, double from);
  void search(const Task& task, double share, double from);

  int steps_;
  Rng rng_;
  std::vector<NodeId> best_;      // what the best walk makes for, in order
  std::vector<Targets> targets_;  // of the last look: none or one
  NearestFirst search_;
};

}  // namespace graphdrl
