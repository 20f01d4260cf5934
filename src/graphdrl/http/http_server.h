// The one HTTP server of the project: pages and interfaces for programs and browsers on this machine.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace graphdrl {

struct HttpLimits {
  // A browser opens six connections; a request for more than these closes the one that has waited longest. Half of
  // the process's file descriptors at most: the other half is for the files that answers are made of.
  std::size_t connections = 256;
  // Browsers keep a connection for their next request, and open a new one where it is closed.
  std::chrono::milliseconds idle{60'000};
  // From the first byte of a request to its last: milliseconds on one machine, seconds through a poor tunnel.
  std::chrono::milliseconds request{10'000};
  // To take an answer whole: minutes for a large page through a poor tunnel. A pause in it may last as long as `idle`.
  std::chrono::milliseconds answer{300'000};
  // Cookies of all servers of this machine come along, whatever their port.
  std::size_t header_bytes = 16 * 1024;
  // Far more than what an explorer sees at one step.
  std::size_t body_bytes = 1024 * 1024;
};

struct HttpRequest {
  std::string method;
  std::string path;   // "/data.json"
  std::string query;  // what follows "?"; often empty
  std::string body;
};

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body = {};  // shared by all who are still reading it; empty for none
  std::string allow = {};                        // with 405: the methods that there are
};
HttpAnswer text_answer(int status, std::string text);

// Answers on 127.0.0.1 alone. One thread, that of run(), speaks to all clients: a connection that is idle, sends slowly
// or reads slowly costs memory and a file descriptor, and holds up nobody. Another thread makes the answers, one at a
// time, so that handlers need no locks.
//
// A request must name this machine as Host, with any port or none, and come from no other site's page (Origin): a page
// whose name resolves to 127.0.0.1 reads nothing and starts nothing here. What is refused: 400 garbage, 403 another
// host or site, 404 unknown path, 405 another method than the path's, 408 too slow, 413 body too large, 431 header too
// large. A handler that throws is answered with 500 and the exception's text.
class HttpServer {
 public:
  // Runs on the server's second thread.
  using Handler = std::function<HttpAnswer(const HttpRequest&)>;

  // Takes the port, which no other program can have then; 0 takes any that is free. Throws Error.
  explicit HttpServer(int port, const HttpLimits& limits = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;

  // Who answers a method ("GET", "POST", "PUT", "DELETE") of a path, or with "/folder/*" of all paths of a folder that
  // have no handlers of their own. GET answers HEAD too. REQUIRES: run() has not begun.
  void on(std::string_view method, std::string_view path, Handler handler);

  // What the handler of a request answers, without a connection. REQUIRES: there is one; run() is not under way.
  HttpAnswer ask(const HttpRequest& request) const;

  // Answers until stop().
  void run();
  // From any thread, also before run(). Waits for nothing.
  void stop();

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace graphdrl
