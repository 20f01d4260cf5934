#include "graphdrl/live/exploration_service.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// The handlers of a service, asked without a network.
class Handlers {
 public:
  explicit Handlers(const ExplorationLimits& limits = {}) : service_(server_, LiveOptions(), limits) {}

  HttpAnswer ask(const std::string& method, const std::string& path, const std::string& body = "") {
    return server_.ask({.method = method, .path = path, .query = "", .body = body});
  }
  std::string begin(const std::string& open = "") {
    const HttpAnswer answer = ask("POST", "/explorations", open);
    EXPECT_EQ(answer.status, 201) << *answer.body;
    return "/explorations/" + nlohmann::json::parse(*answer.body)["exploration"].get<std::string>();
  }

 private:
  HttpServer server_ = HttpServer(0);
  ExplorationService service_;
};

TEST(ExplorationService, KeepsExplorationsApart) {
  Handlers handlers;
  const std::string one = handlers.begin();
  const std::string two = handlers.begin(R"({"open":{"reset_cost":1}})");
  EXPECT_NE(one, two);
  EXPECT_EQ(*handlers.ask("POST", one, R"({"id":1,"state":"a","moves":["x"]})").body, "{\"id\":1,\"move\":\"x\"}\n");
  EXPECT_EQ(*handlers.ask("POST", two, R"({"id":1,"state":"b","moves":["y"]})").body, "{\"id\":1,\"move\":\"y\"}\n");
  EXPECT_THAT(*handlers.ask("POST", one, R"({"id":2,"state":"c","moves":[]})").body, HasSubstr("\"done\":\"covered\""));
  const HttpAnswer transcript = handlers.ask("GET", two);
  EXPECT_EQ(std::ranges::count(*transcript.body, '\n'), 3) << *transcript.body;
  EXPECT_THAT(*transcript.body, StartsWith("{\"live\":1"));
  EXPECT_THAT(*handlers.ask("DELETE", two).body, StartsWith("{\"done\":\"closed\",\"report\":{\"steps\":0"));
  EXPECT_EQ(handlers.ask("GET", two).status, 404);
  EXPECT_EQ(handlers.ask("GET", one).status, 200);
}

TEST(ExplorationService, RefusesWhatItCannotTake) {
  Handlers handlers({.explorations = 2, .transcript_bytes = 300});
  const std::string one = handlers.begin();
  handlers.begin();
  EXPECT_EQ(handlers.ask("POST", "/explorations").status, 429);
  EXPECT_EQ(handlers.ask("POST", one, "nonsense").status, 400);
  EXPECT_EQ(handlers.ask("POST", "/explorations/none", "{}").status, 404);
  EXPECT_EQ(handlers.ask("DELETE", "/explorations/none").status, 404);
  for (int i = 0; i < 20; ++i) handlers.ask("POST", one, R"({"state":"a","moves":["x"]})");
  EXPECT_EQ(handlers.ask("GET", one).status, 413);
  handlers.ask("DELETE", one);
  EXPECT_EQ(handlers.ask("POST", "/explorations", R"({"open":{"cover":"faces"}})").status, 400);
  EXPECT_EQ(handlers.ask("POST", "/explorations", R"({"state":"a"})").status, 400);
  handlers.begin();
}

TEST(ExplorationService, EndsIdleOnes) {
  Handlers handlers({.idle = std::chrono::milliseconds(1)});
  const std::string one = handlers.begin();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(handlers.ask("GET", one).status, 404);
}

}  // namespace
}  // namespace graphdrl
