#include "graphdrl/http/http_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support.h"

namespace graphdrl {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kPatienceSeconds = 60;  // a test that waits so long has failed
const std::string kHost = "Host: localhost\r\n";

// A connection that says what it is told to.
class Client {
 public:
  explicit Client(const HttpServer& server) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience = {.tv_sec = kPatienceSeconds, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  Client& say(const std::string& text) {
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t size = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (size <= 0) break;  // refused already
      sent += static_cast<std::size_t>(size);
    }
    return *this;
  }
  Client& get(const std::string& path) { return say("GET " + path + " HTTP/1.1\r\n" + kHost + "\r\n"); }
  Client& end() {
    shutdown(socket_, SHUT_WR);
    return *this;
  }

  // What comes up to and with `mark`; all until the server closes where it does not come.
  std::string hear(const std::string& mark) {
    while (heard_.find(mark) == std::string::npos && hear_more()) {
    }
    const std::size_t found = heard_.find(mark);
    const std::size_t length = found == std::string::npos ? heard_.size() : found + mark.size();
    std::string text = heard_.substr(0, length);
    heard_.erase(0, length);
    return text;
  }
  std::string hear_all() {
    while (hear_more()) {
    }
    return std::exchange(heard_, {});
  }

 private:
  bool hear_more() {
    std::vector<char> chunk(1 << 16);
    const ssize_t size = recv(socket_, chunk.data(), chunk.size(), 0);
    EXPECT_FALSE(size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) << "the server neither answers nor closes";
    if (size > 0) heard_.append(chunk.data(), static_cast<std::size_t>(size));
    return size > 0;
  }

  int socket_;
  std::string heard_;
};

// A server that answers "/" with "hello!", echoes what is posted to "/echo", and fails at "/bad".
class Running {
 public:
  explicit Running(const HttpLimits& limits = {}) : server(0, limits) {
    server.on("GET", "/", [](const HttpRequest&) { return text_answer(200, "hello!"); });
    server.on("POST", "/echo", [](const HttpRequest& request) {
      return text_answer(200, request.method + request.path + request.query + request.body + "!");
    });
    server.on("GET", "/bad", [](const HttpRequest&) -> HttpAnswer { throw std::runtime_error("no page"); });
  }
  ~Running() { server.stop(); }
  void start() {
    thread_ = std::jthread([this] { server.run(); });
  }

  HttpServer server;

 private:
  std::jthread thread_;
};

std::string said_to(const std::string& request, const HttpLimits& limits = {}) {
  Running running(limits);
  running.start();
  return Client(running.server).say(request).end().hear_all();
}

TEST(HttpServer, AnswersManyRequestsOnOneConnection) {
  Running running;
  running.start();
  Client client(running.server);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(client.get("/?again").hear("hello!"), StartsWith("HTTP/1.1 200 OK\r\n"));
  // Two requests at once, and one in single bytes.
  client.get("/").get("/");
  EXPECT_THAT(client.hear("hello!"), StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(client.hear("hello!"), StartsWith("HTTP/1.1 200 OK\r\n"));
  for (const char c : "POST /echo?why HTTP/1.1\r\n" + kHost + "Content-Length: 3\r\n\r\nabc") client.say({c});
  EXPECT_THAT(client.hear("!"), HasSubstr("\r\n\r\nPOST/echowhyabc!"));
  client.say("POST /echo HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\n2\r\nab\r\n1\r\nc\r\n0\r\n\r\n");
  EXPECT_THAT(client.hear("!"), HasSubstr("\r\n\r\nPOST/echoabc!"));
  client.say("POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: 1\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.hear("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_THAT(client.say("a").hear("!"), HasSubstr("\r\n\r\nPOST/echoa!"));
  EXPECT_THAT(client.get("/bad").hear("no page"), StartsWith("HTTP/1.1 500 Internal Server Error\r\n"));
  EXPECT_THAT(client.get("/nowhere").hear("Not Found\n"), StartsWith("HTTP/1.1 404 Not Found\r\n"));
  client.say("HEAD / HTTP/1.1\r\n" + kHost + "Connection: close\r\n\r\n");
  const std::string head = client.hear_all();
  EXPECT_THAT(head, HasSubstr("Content-Length: 6\r\n"));
  EXPECT_THAT(head, testing::EndsWith("Connection: close\r\n\r\n"));
}

TEST(HttpServer, KeepsConnectionsOfOldClientsThatAskForIt) {
  Running running;
  running.start();
  Client client(running.server);
  client.say("GET / HTTP/1.0\r\n" + kHost + "Connection: keep-alive\r\n\r\n");
  EXPECT_THAT(client.hear("hello!"), HasSubstr("Connection: keep-alive\r\n"));
  EXPECT_THAT(client.say("GET / HTTP/1.0\r\n" + kHost + "\r\n").hear_all(), HasSubstr("Connection: close\r\n"));
}

TEST(HttpServer, ServesThisMachineAlone) {
  const auto asked_as = [](const std::string& headers) {
    return said_to("GET / HTTP/1.1\r\n" + headers + "\r\n").substr(9, 3);
  };
  for (const char* const host : {"localhost", "127.0.0.1", "[::1]", "LocalHost:8000", "127.0.0.1:80", "[::1]:65535"}) {
    EXPECT_EQ(asked_as("Host: " + std::string(host) + "\r\n"), "200") << host;
    EXPECT_EQ(asked_as("Host: " + std::string(host) + "\r\nOrigin: http://" + host + "\r\n"), "200") << host;
  }
  for (const char* const host : {"another.example", "another.example:8000", "localhost.example", "127.0.0.1.example",
                                 "127.0.0.1:80.example", "[::1", "::1", ":80", "", "127.0.0.2", "a@localhost"}) {
    EXPECT_EQ(asked_as("Host: " + std::string(host) + "\r\n"), "403") << host;
  }
  EXPECT_EQ(asked_as(""), "400");
  EXPECT_EQ(asked_as(kHost + "Host: another.example\r\n"), "400");
  EXPECT_EQ(asked_as(kHost + "Origin: http://another.example\r\n"), "403");
  EXPECT_EQ(asked_as(kHost + "Origin: http://localhost:9000\r\n"), "403");
  EXPECT_EQ(asked_as(kHost + "Origin: null\r\n"), "403");
}

TEST(HttpServer, RefusesWhatItDoesNotUnderstand) {
  for (const std::string& request : {
           std::string("hello\r\n\r\n"),
           std::string("\0\xff\x7f\r\n\r\n", 7),
           "GET / HTTP/2.0\r\n" + kHost + "\r\n",
           "GET / HTTP/1.1\r\n" + kHost + "a b: c\r\n\r\n",
           "GET  / HTTP/1.1\r\n" + kHost + "\r\n",
           "POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: -1\r\n\r\n",
           "POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: 99999999999999999999\r\n\r\n",
           "POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n",
           "POST /echo HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\nxyz\r\n",
           "POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: 9\r\n\r\nhalf",
           std::string("GET / HT"),
       }) {
    EXPECT_EQ(said_to(request).substr(0, 13), "HTTP/1.1 400 ") << request;
  }
  EXPECT_THAT(said_to(""), IsEmpty());
  EXPECT_THAT(said_to("GET http://localhost/ HTTP/1.1\r\n" + kHost + "\r\n"), StartsWith("HTTP/1.1 404 "));
  for (const std::string& method : {std::string("DELETE"), std::string("BREW"), std::string("GET")}) {
    const std::string answer = said_to(method + " /echo HTTP/1.1\r\n" + kHost + "\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 405 ")) << method;
    EXPECT_THAT(answer, HasSubstr("Allow: POST\r\n")) << method;
  }
  EXPECT_THAT(said_to("POST / HTTP/1.1\r\n" + kHost + "\r\n"), HasSubstr("Allow: GET, HEAD\r\n"));
}

TEST(HttpServer, LimitsWhatARequestMayHold) {
  const HttpLimits limits = {.header_bytes = 1000, .body_bytes = 1000};
  const std::string begin = "POST /echo HTTP/1.1\r\n" + kHost;
  const auto status_of = [&](const std::string& request) { return said_to(request, limits).substr(9, 3); };
  EXPECT_EQ(status_of(begin + "Content-Length: 1000\r\n\r\n" + std::string(1000, 'a')), "200");
  EXPECT_EQ(status_of(begin + "Content-Length: 1001\r\n\r\n"), "413");
  EXPECT_EQ(status_of(begin + "Transfer-Encoding: chunked\r\n\r\n3e9\r\n" + std::string(1001, 'a')), "413");
  std::string tiny_chunks = begin + "Transfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 900; ++i) tiny_chunks += "1;extension=long\r\na\r\n";
  EXPECT_EQ(status_of(tiny_chunks), "413");
  EXPECT_EQ(status_of(begin + "Cookie: " + std::string(900, 'a') + "\r\n\r\n"), "200");
  EXPECT_EQ(status_of(begin + "Cookie: " + std::string(1000, 'a') + "\r\n\r\n"), "431");
  EXPECT_EQ(status_of(begin + "Cookie: " + std::string(10'000, 'a')), "431");
  EXPECT_EQ(status_of("GET /" + std::string(10'000, 'a')), "431");
  // Many short fields that arrive one by one.
  Running running(limits);
  running.start();
  Client client(running.server);
  client.say(begin);
  for (int i = 0; i < 200; ++i) client.say("Accept: everything\r\n");
  EXPECT_THAT(client.hear_all(), StartsWith("HTTP/1.1 431 "));
}

TEST(HttpServer, ClosesTheLongestIdleOfTooManyConnections) {
  Running running({.connections = 3});
  running.start();
  Client first(running.server);
  first.get("/").hear("hello!");
  Client second(running.server);
  Client third(running.server);
  third.get("/").hear("hello!");
  second.get("/").hear("hello!");
  first.get("/").hear("hello!");  // now the third has waited longest
  Client fourth(running.server);
  EXPECT_THAT(fourth.get("/").hear("hello!"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(third.hear_all(), IsEmpty());
  EXPECT_THAT(first.get("/").hear("hello!"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(second.get("/").hear("hello!"), StartsWith("HTTP/1.1 200"));
}

TEST(HttpServer, EndsRequestsThatDoNotArrive) {
  Running running({.idle = milliseconds(50), .request = milliseconds(50)});
  running.start();
  Client idle(running.server);
  Client half(running.server);
  Client without_body(running.server);
  half.say("GET / HTTP/1.1\r\nHost:");
  without_body.say("POST /echo HTTP/1.1\r\n" + kHost + "Content-Length: 9\r\n\r\nhalf");
  EXPECT_THAT(half.hear_all(), StartsWith("HTTP/1.1 408 Request Timeout\r\n"));
  EXPECT_THAT(without_body.hear_all(), StartsWith("HTTP/1.1 408 Request Timeout\r\n"));
  EXPECT_THAT(idle.hear_all(), IsEmpty());
}

TEST(HttpServer, ASlowSenderDoesNotExtendItsTime) {
  Running running({.request = milliseconds(100)});
  running.start();
  Client client(running.server);
  client.say("GET / HTTP/1.1\r\nCookie: ");
  std::jthread drip([&](const std::stop_token& stopped) {
    while (!stopped.stop_requested()) {
      client.say("a");
      std::this_thread::sleep_for(milliseconds(10));
    }
  });
  EXPECT_THAT(client.hear("Timeout\n"), StartsWith("HTTP/1.1 408 Request Timeout\r\n"));
}

// More than the sockets' buffers hold.
std::shared_ptr<const std::string> large_page() {
  return std::make_shared<const std::string>(64 << 20, 'a');
}

TEST(HttpServer, AClientThatNeverReadsHoldsUpNobody) {
  Running running;
  const auto large = large_page();
  running.server.on("GET", "/large", [&](const HttpRequest&) { return HttpAnswer{.body = large}; });
  running.start();
  Client slow(running.server);
  slow.get("/large").hear("\r\n\r\n");
  for (int i = 0; i < 10; ++i) EXPECT_THAT(Client(running.server).get("/").hear("hello!"), StartsWith("HTTP/1.1 200"));
  Client quick(running.server);
  EXPECT_GT(quick.say("GET /large HTTP/1.0\r\n" + kHost + "\r\n").hear_all().size(), large->size());
}

TEST(HttpServer, EndsAnswersThatNobodyTakes) {
  for (const HttpLimits& limits : {HttpLimits{.idle = milliseconds(50)}, HttpLimits{.answer = milliseconds(50)}}) {
    Running running(limits);
    const auto large = large_page();
    running.server.on("GET", "/large", [&](const HttpRequest&) { return HttpAnswer{.body = large}; });
    running.start();
    Client slow(running.server);
    slow.get("/large").hear("\r\n\r\n");
    while (large.use_count() > 1) std::this_thread::sleep_for(milliseconds(10));
    EXPECT_LT(slow.hear_all().size(), large->size());
  }
}

TEST(HttpServer, ASlowAnswerHoldsUpOnlyOtherAnswers) {
  Running running({.connections = 2});
  std::latch asked(1);
  std::latch go_on(1);
  running.server.on("GET", "/slow", [&](const HttpRequest&) {
    asked.count_down();
    go_on.wait();
    return text_answer(200, "done!");
  });
  running.start();
  Client slow(running.server);
  slow.get("/slow");
  asked.wait();
  // Neither the limit of connections nor another client's mistake touches who is being answered.
  for (int i = 0; i < 5; ++i) EXPECT_THAT(Client(running.server).get("/nowhere").hear("Found\n"), HasSubstr(" 404 "));
  Client next(running.server);
  next.get("/");
  Client over_the_limit(running.server);
  go_on.count_down();
  EXPECT_THAT(slow.hear("done!"), StartsWith("HTTP/1.1 200 "));
}

TEST(HttpServer, HasItsPortAlone) {
  const HttpServer server(0);
  EXPECT_THAT(error_of([&] { HttpServer another(server.port()); }), HasSubstr("the port cannot be used"));
}

TEST(HttpServer, EndsWithClientsConnected) {
  auto running = std::make_unique<Running>();
  running->start();
  Client idle(running->server);
  Client half(running->server);
  half.say("GET / HT");
  EXPECT_THAT(Client(running->server).get("/").hear("hello!"), StartsWith("HTTP/1.1 200"));
  running.reset();
  EXPECT_THAT(idle.hear_all(), IsEmpty());
  EXPECT_THAT(half.hear_all(), IsEmpty());
}

}  // namespace
}  // namespace graphdrl
