// The live protocol: one JSON object in, one out. docs/live.md shows every message.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "graphdrl/live/live_exploration.h"

namespace graphdrl {

inline constexpr int kLiveProtocol = 1;
inline constexpr std::size_t kLongestLiveMessage = std::size_t{64} << 20;  // bytes: a million moves with names of sixty

// The options of an exploration as an `open` message has them. Throws Error on an unknown field, and on a bad value.
LiveOptions parse_live_options(const nlohmann::json& open, const LiveOptions& defaults);
nlohmann::ordered_json live_options_json(const LiveOptions& options);

nlohmann::ordered_json live_report_json(const LiveReport& report);

// One client's exploration. Not thread safe.
class LiveSession {
 public:
  // Told of every message that was taken, and of its answer, before it is given: both without line breaks. `open`
  // messages come as they are resolved.
  using Record = std::function<void(std::string_view message, std::string_view answer)>;

  explicit LiveSession(LiveOptions defaults, Record record = {});

  // What to answer to a message, without a line break. Bad ones are answered with an error and change nothing. What the
  // record throws gets through. After that, and after a failure of ours, all that follows is refused.
  std::string answer(std::string_view message);
  // Whether the last answer was an error.
  bool refused() const { return refused_; }

  // A message that was taken before, and its answer: of a transcript. Policies choose anew unless their time to think
  // is limited; where that comes out otherwise the transcript holds, and this gives false. Throws Error on messages
  // that do not fit.
  bool replay(std::string_view message, std::string_view answer);

  // The last answer to a message that was taken; empty before.
  const std::string& last_answer() const { return last_answer_; }

  // The end, where the last answer was not that already: {"done": "closed", "report": …}.
  std::optional<std::string> close() const;
  std::string report() const;  // {"done": "closed", "report": …}, whatever the last answer was

  // Null until something was observed.
  const LiveExploration* exploration() const {
    return exploration_ && exploration_->observed() ? &*exploration_ : nullptr;
  }

 private:
  static constexpr std::size_t kAnswersKept = 1024;  // for ids that come again
  static constexpr std::size_t kLongestId = 256;     // bytes

  struct Answered {
    std::string id;  // as JSON
    std::string answer;
  };

  nlohmann::ordered_json take(const nlohmann::json& message);
  void open(const nlohmann::json& options);
  nlohmann::ordered_json step_json(const LiveStep& step) const;
  const std::string* answered(const std::string& id) const;
  void keep(const std::string& id, const std::string& answer);

  LiveOptions defaults_;
  Record record_;
  std::optional<LiveExploration> exploration_;
  std::deque<Answered> answered_;
  std::string last_answer_;
  std::string broken_;  // why nothing is taken any more
  bool refused_ = false;
  bool done_ = false;
};

}  // namespace graphdrl
