#include "graphdrl/live/session.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graphdrl/io/file.h"
#include "graphdrl/live/transcript.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(LiveSession, AnswersMessages) {
  LiveSession session({});
  EXPECT_EQ(session.answer(R"({"id":0,"open":{"protocol":1,"cover":"edges","reset_cost":1}})"),
            R"({"id":0,"ok":true,"protocol":1})");
  EXPECT_EQ(session.answer(R"({"id":1,"state":"login","moves":["ok",{"move":"help","to":"help","cost":2}]})"),
            R"({"id":1,"move":"ok"})");
  EXPECT_EQ(session.answer(R"({"id":"two","state":"inbox","cost":1.5,"moves":[]})"),
            R"({"id":"two","reset":true,"expects":"login"})");
  EXPECT_EQ(session.answer(R"({"state":"login"})"), R"({"move":"help","expects":"help"})");
  EXPECT_EQ(session.answer(R"({"id":4,"state":"login","failed":true})"), R"({"id":4,"move":"help","expects":"help"})");
  EXPECT_EQ(session.answer(R"({"id":5,"state":"help","moves":[]})"),
            R"({"id":5,"done":"covered","report":{"steps":4,"cost":6.5,"state":"help","states":3,"transitions":2,)"
            R"("resets":1,"failed":[],"surprises":[],"surprise_count":0,"unreachable":[]}})");
  EXPECT_EQ(session.close(), std::nullopt);
}

TEST(LiveSession, SendsARobotThroughCells) {
  LiveSession session({});
  EXPECT_EQ(session.answer(R"({"id":0,"open":{"score":"seen","connectivity":4,"end":"start"}})"),
            R"({"id":0,"ok":true,"protocol":1})");
  EXPECT_EQ(session.answer(R"({"id":1,"at":[3.2,1.5],"cells":{"origin":[3,1],"resolution":0.5,"width":3,"height":3,)"
                           R"("data":[100,100,100,0,0,-1,100,100,-1]}})"),
            R"({"id":1,"goto":[[3.75,1.75]]})");
  EXPECT_EQ(session.answer(R"({"id":2,"at":[3.75,1.75],"failed":true})"), R"({"id":2,"goto":[[3.25,1.75]]})");
  EXPECT_EQ(session.exploration()->report().cells->failed.size(), 1u);
  for (const auto& [message, expected] : std::vector<std::pair<const char*, const char*>>{
           {R"({"state":"a"})", "one of cells"},
           {R"({"at":[1]})", "[x, y]"},
           {R"({"at":[0,0],"moves":[]})", "an unknown field"},
           {R"({"at":[0,0],"cells":{"origin":[0,0]}})", "resolution is missing"},
           {R"({"at":[0,0],"cells":{"origin":[3,1],"resolution":0.5,"width":1,"height":1,"data":[101]}})", "-1 to 100"},
           {R"({"at":[0,0],"cells":{"origin":[3,1],"resolution":0.5,"width":-1,"height":1,"data":[]}})", "width"},
           {R"({"at":[0,0],"cells":{"origin":[3,1],"resolution":0.5,"width":2,"height":1,"data":[1]}})", "2 × 1"},
       }) {
    EXPECT_THAT(session.answer(message), HasSubstr(expected)) << message;
    EXPECT_TRUE(session.refused()) << message;
  }
}

TEST(LiveSession, GivesTheSameAnswerToARepeatedId) {
  LiveSession session({});
  const std::string first = session.answer(R"({"id":1,"state":"a","moves":["x","y"]})");
  EXPECT_EQ(session.answer(R"({"id":1,"state":"a","moves":["x","y"]})"), first);
  EXPECT_EQ(session.exploration()->report().steps, 0);
}

TEST(LiveSession, SaysWhatIsWrongAndChangesNothing) {
  LiveSession session({});
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"", "not JSON"},
      {"[1]", "not an object"},
      {"{}", "says where the client is"},
      {R"({"id":1,"state":"a","cost":NaN})", "NaN"},
      {R"({"id":1,"state":"a","cost":-1})", R"("field":"cost")"},
      {R"({"id":1,"state":"a","cost":1e999})", "a number too large"},
      {R"({"id":1,"state":7})", R"("field":"state")"},
      {R"({"id":1,"state":"a","colour":"red"})", "an unknown field"},
      {R"({"id":1,"state":"a","moves":"x"})", "a list"},
      {R"({"id":1,"state":"a","moves":[{"to":"b"}]})", "a move has no name"},
      {R"({"id":1,"state":"a","moves":["x","x"]})", "twice"},
      {R"({"id":1,"state":"a","moves":[1]})", "not an object"},
      {R"({"id":[],"state":"a"})", R"("field":"id")"},
      {R"({"id":1,"state":"a","cost":1e300})", R"("field":"cost")"},
      {R"({"id":1,"state":"a","explorer":1})", "there is one explorer"},
      {R"({"id":1,"open":{"protocol":2}})", R"("field":"protocol")"},
      {R"({"id":1,"open":{"cover":"faces"}})", "nodes or edges"},
      {R"({"id":1,"open":{"budget":-1}})", R"("field":"budget")"},
      {R"({"id":1,"open":{"policy":"best"}})", "no such policy"},
      {R"({"id":1,"open":{"end":"b"}})", "anywhere or start"},
      {R"({"id":1,"open":{"seed":-1}})", "a whole number"},
  };
  for (const auto& [message, expected] : cases) {
    const std::string answer = session.answer(message);
    EXPECT_THAT(answer, HasSubstr("\"error\"")) << message;
    EXPECT_THAT(answer, HasSubstr(expected)) << message;
    EXPECT_EQ(session.exploration(), nullptr) << message;
  }
  EXPECT_THAT(session.answer(std::string(200, '[')), HasSubstr("nested too deeply"));
  EXPECT_THAT(session.answer(R"({"id":")" + std::string(300, 'x') + R"(","state":"a"})"), HasSubstr("256 bytes"));
  EXPECT_TRUE(session.refused());
  EXPECT_EQ(session.answer(R"({"id":1,"open":{}})"), R"({"id":1,"ok":true,"protocol":1})") << "it still can be opened";
  EXPECT_EQ(session.answer(R"({"id":2,"open":{"cover":"edges"}})"), R"({"id":2,"ok":true,"protocol":1})");
  session.answer(R"({"state":"a"})");
  EXPECT_THAT(session.answer(R"({"id":3,"open":{}})"), HasSubstr("has begun"));
}

TEST(LiveSession, ClosesWithAReport) {
  LiveSession session({});
  session.answer(R"({"state":"a","moves":["x"]})");
  EXPECT_THAT(session.close().value_or(""), StartsWith(R"({"done":"closed","report":{"steps":0)"));
}

// A machine of four states that answers what it is told.
std::vector<std::string> drive(LiveSession& session, int from, int to) {
  static std::string state;
  if (from == 0) state = "0";
  std::vector<std::string> answers;
  for (int turn = from; turn < to; ++turn) {
    answers.push_back(
        session.answer(nlohmann::json{{"id", turn}, {"state", state}, {"moves", {"a", "b", "c"}}}.dump()));
    const auto answer = nlohmann::json::parse(answers.back());
    if (answer.contains("move")) {
      state = std::to_string((std::stoi(state) * 3 + answer["move"].get<std::string>()[0]) % 7);
    }
  }
  return answers;
}

TEST(LiveSession, TakesNothingMoreOnceItCouldNotWrite) {
  LiveSession session({}, [](auto, auto) { throw Error({.what = "the disk is full"}); });
  EXPECT_THAT(error_of([&] { session.answer(R"({"state":"a","moves":["x"]})"); }), HasSubstr("full"));
  EXPECT_THAT(session.answer(R"({"state":"b"})"), HasSubstr("could not be written"));
}

TEST(Transcript, GoesOnWhereItEnds) {
  const TemporaryFolder folder;
  const LiveOptions options{.cover = Cover::kEdges};
  LiveSession whole(options);
  const std::vector<std::string> answers = drive(whole, 0, 30);
  for (const int killed : {0, 1, 7, 29}) {
    const auto file = folder / ("killed" + std::to_string(killed));
    {
      Transcript transcript(file, options, /*sync=*/true);
      LiveSession session(options, [&](auto message, auto answer) { transcript.add(message, answer); });
      drive(session, 0, killed);
    }
    write_file(file, read_file(file) + R"({"message":{"id":)");  // half a line
    const LiveRun replayed = begin_live(options, {.file = file, .resume = true});
    EXPECT_TRUE(replayed.torn);
    EXPECT_EQ(replayed.turns, killed);
    EXPECT_EQ(replayed.other_turn, 0);
    // The client may ask again for what it was not told.
    if (killed > 0) {
      const auto message = nlohmann::json{{"id", killed - 1}, {"state", "?"}};
      EXPECT_EQ(replayed.session->answer(message.dump()), answers[killed - 1]);
    }
    const std::vector<std::string> rest = drive(*replayed.session, killed, 30);
    EXPECT_TRUE(std::equal(rest.begin(), rest.end(), answers.begin() + killed)) << killed;
  }
}

TEST(Transcript, HoldsWhateverThePolicyWouldChoose) {
  const TemporaryFolder folder;
  write_file(folder / "t",
             "{\"live\":1,\"options\":{\"protocol\":1,\"policy\":\"nearest\"}}\n"
             "{\"message\":{\"state\":\"a\",\"moves\":[{\"move\":\"x\",\"cost\":1},{\"move\":\"y\",\"cost\":2}]},"
             "\"answer\":{\"move\":\"y\"}}\n");
  const LiveRun replayed = replay_transcript(folder / "t");
  EXPECT_EQ(replayed.other_turn, 1);
  replayed.session->answer(R"({"state":"b","moves":[]})");
  EXPECT_EQ(replayed.session->exploration()->report().cost, 2) << "y was done";
}

TEST(Transcript, RefusesOtherFiles) {
  const TemporaryFolder folder;
  write_file(folder / "map", "..\n..\n");
  write_file(folder / "odd", "{\"live\":1,\"options\":{}}\n{\"message\":{}}\n");
  write_file(folder / "bad",
             "{\"live\":1,\"options\":{}}\n{\"message\":{\"state\":\"a\"},\"answer\":{\"move\":\"x\"}}\n");
  EXPECT_THAT(error_of([&] { replay_transcript(folder / "map"); }), HasSubstr("no transcript"));
  write_file(folder / "other", "{\"live\":9,\"options\":{}}\n");
  EXPECT_THAT(error_of([&] { replay_transcript(folder / "other"); }), HasSubstr("another protocol"));
  for (const char* const answer : {"{}", "5"}) {
    write_file(folder / "none",
               std::string("{\"live\":1,\"options\":{}}\n{\"message\":{\"state\":\"a\"},\"answer\":") + answer + "}\n");
    EXPECT_THAT(error_of([&] { replay_transcript(folder / "none"); }), HasSubstr("line 2")) << answer;
  }
  for (const char* const begun : {"", "{\"liv"}) {  // killed before the first line was whole
    write_file(folder / "begun", begun);
    EXPECT_EQ(begin_live({}, {.file = folder / "begun", .resume = true}).turns, 0);
    EXPECT_THAT(read_file(folder / "begun"), StartsWith("{\"live\":1"));
  }
  EXPECT_THAT(error_of([&] { replay_transcript(folder / "odd"); }), HasSubstr("line 2"));
  EXPECT_THAT(error_of([&] { replay_transcript(folder / "bad"); }), HasSubstr("no such move"));
  EXPECT_THAT(error_of([&] { begin_live({}, {.file = folder / "bad"}); }), HasSubstr("there already"));
  EXPECT_THAT(error_of([&] { begin_live({.policy = "best"}, {.file = folder / "new"}); }), HasSubstr("no such policy"));
  EXPECT_FALSE(std::filesystem::exists(folder / "new"));
}

}  // namespace
}  // namespace graphdrl
