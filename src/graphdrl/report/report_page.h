// The report page: one HTML file with replays of plans, curves of trainings and tables of evaluations. The page's own
// files are in report/page/; docs/report.md says what its data looks like.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "graphdrl/report/move_scores.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {

class ReportPage {
 public:
  // watch: the page asks its server for data.json every two seconds.
  explicit ReportPage(const std::string& title, bool watch = false);

  // Plans on one world are shown together, two of them side by side.
  void add_plan(const Answer& answer, const std::optional<MoveScores>& scores = {});

  // The curves of a run: the lines of its metrics.jsonl. Ignores a last line that is still being written. Throws Error.
  void add_run(const std::string& name, const std::filesystem::path& folder);

  // evaluation: what `graphdrl evaluate --json` prints.
  void add_evaluation(const std::string& name, const nlohmann::json& evaluation);

  // The same page with nothing on it yet, for the same worlds: they are not laid out again.
  ReportPage emptied() const;

  // The data of the page, as one JSON document.
  std::string data() const;

  // The page. It asks the network for nothing; a watching page asks its server for data.json.
  std::string html() const;

 private:
  nlohmann::ordered_json document_;
  std::map<std::string, nlohmann::ordered_json> worlds_;  // those shown, by name
};

}  // namespace graphdrl
