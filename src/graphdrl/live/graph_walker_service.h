// GraphWalker's REST service, with planned walks behind it.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "graphdrl/graph/graph_map.h"
#include "graphdrl/http/http_server.h"
#include "graphdrl/live/graph_walker_model.h"

namespace graphdrl {

// A walk through one model, element by element: edges and the vertices that they lead to. Edges are covered by the
// shortest walk over all of them [postman_walk()]; where there is none, and for vertices, by going to the nearest one
// that was not walked yet.
class ModelWalk {
 public:
  explicit ModelWalk(WalkerModel model);

  const WalkerModel& model() const { return model_; }

  // Whether there is a next element: the stop condition does not hold yet, and the walk can go on.
  bool has_next();
  struct Element {
    bool edge;
    int number;  // in the model
  };
  // REQUIRES: has_next().
  Element next();
  void fail() { failed_ = true; }

  bool begun() const { return steps_ > 0; }
  bool failed() const { return failed_; }
  bool fulfilled() const;
  bool walked(int edge) const { return walked_[edge]; }
  bool visited(NodeId vertex) const { return visited_[vertex]; }
  int walked_count() const { return walked_count_; }
  int visited_count() const { return visited_count_; }

 private:
  bool holds(const StopCondition::Term& term) const;
  bool plan();
  void plan_over_edges(bool again);
  template <typename Aim>
  void plan_to(const Aim& aimed_at);

  WalkerModel model_;
  Multigraph graph_;                                // its edges but those from nowhere …
  std::vector<int> number_of_;                      // … and their numbers in the model
  std::vector<std::vector<std::int64_t>> leaving_;  // [vertices], edges of graph_
  std::vector<bool> walked_;                        // [edges]
  std::vector<bool> visited_;                       // [vertices]
  int walked_count_ = 0;
  int visited_count_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t pairs_ = 0;           // edges with their vertices
  NodeId position_ = kNoNode;        // before the first vertex: none
  int edge_ = -1;                    // walked last, whose vertex comes next
  std::vector<std::int64_t> ahead_;  // edges of graph_, the next one last
  bool failed_ = false;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

// One session: load, hasNext, getNext, getData, setData, restart, fail, getStatistics under /graphwalker. Models are
// walked one after the other.
class GraphWalkerService {
 public:
  // Adds its handlers to a server, which must not run yet and not outlive it. models: loaded already; empty for none.
  GraphWalkerService(HttpServer& server, std::vector<WalkerModel> models);

 private:
  HttpAnswer load(const HttpRequest& request);
  HttpAnswer has_next(const HttpRequest& request);
  HttpAnswer get_next(const HttpRequest& request);
  HttpAnswer get_data(const HttpRequest& request);
  HttpAnswer set_data(const HttpRequest& request);
  HttpAnswer restart(const HttpRequest& request);
  HttpAnswer fail(const HttpRequest& request);
  HttpAnswer statistics(const HttpRequest& request);

  void begin();
  ModelWalk* current();

  std::vector<WalkerModel> models_;
  std::vector<ModelWalk> walks_;
  std::size_t current_ = 0;
  std::map<std::string, std::string> data_;
};

}  // namespace graphdrl
