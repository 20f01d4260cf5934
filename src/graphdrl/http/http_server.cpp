#include "graphdrl/http/http_server.h"

#ifdef __SANITIZE_THREAD__
#define BOOST_ASIO_DISABLE_FENCED_BLOCK  // it knows no fences; the queues' locks order what the two threads do
#endif
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/basic_waitable_timer.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/string_body.hpp>
#include <map>
#include <optional>
#include <thread>
#include <unordered_set>
#include <utility>
#include <vector>

#include "graphdrl/base/error.h"

namespace graphdrl {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

// Of the loop's own kind: types that hide it take longer to compile.
using Executor = asio::io_context::executor_type;
using Socket = asio::basic_stream_socket<tcp, Executor>;
using Acceptor = asio::basic_socket_acceptor<tcp, Executor>;
using Steady = std::chrono::steady_clock;
using Timer = asio::basic_waitable_timer<Steady, asio::wait_traits<Steady>, Executor>;
using Parser = http::request_parser<http::string_body>;

constexpr std::size_t kReadBytes = 8192;                  // at once
constexpr std::chrono::milliseconds kSweep{100};          // how often deadlines are looked at
constexpr std::chrono::milliseconds kLinger{2000};        // for a client to read why it is refused
constexpr std::chrono::milliseconds kNoDescriptors{100};  // until the next try to accept a connection
constexpr std::size_t kChunkOverhead = 2;                 // a body sent in chunks takes more bytes than it has

// "localhost", "127.0.0.1:8000": any port, since a tunnel has its own.
bool is_this_machine(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  if (colon != std::string_view::npos && colon >= host.rfind(']') + 1) {
    const std::string_view port = host.substr(colon + 1);
    if (port.find_first_not_of("0123456789") != std::string_view::npos) return false;
    host = host.substr(0, colon);
  }
  const boost::beast::string_view name(host.data(), host.size());
  return name == "127.0.0.1" || name == "[::1]" || boost::beast::iequals(name, "localhost");
}

HttpAnswer refused(http::status status) {
  return text_answer(static_cast<int>(status), std::string(http::obsolete_reason(status)) + '\n');
}

http::status status_of(error_code problem) {
  if (problem == http::error::header_limit) return http::status::request_header_fields_too_large;
  if (problem == http::error::body_limit) return http::status::payload_too_large;
  return http::status::bad_request;
}

// So many that as many descriptors again are left.
std::size_t most_connections(std::size_t wanted) {
  rlimit descriptors = {};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) != 0) return wanted;
  return std::clamp<std::size_t>(descriptors.rlim_cur / 2, 1, wanted);
}

}  // namespace

HttpAnswer text_answer(int status, std::string text) {
  return {.status = status, .body = std::make_shared<const std::string>(std::move(text))};
}

// The loop's data belongs to its thread, apart from `routes_`, which does not change while it runs.
class HttpServer::Loop {
 public:
  Loop(int port, const HttpLimits& limits) : limits_(limits), most_connections_(most_connections(limits.connections)) {
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port));
    try {
      acceptor_.open(endpoint.protocol());
      // A port that connections of an ended program still wait on; no second program can listen on it.
      acceptor_.set_option(Acceptor::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw Error({.what = "the port cannot be used",
                   .got = fmt::format("{} ({})", port, error.code().message()),
                   .where = "--port"});
    }
  }

  int port() const { return acceptor_.local_endpoint().port(); }

  HttpAnswer ask(const HttpRequest& request) const { return (*handler_of(request.path, request.method))(request); }

  void on(std::string_view method, std::string_view path, Handler handler) {
    routes_[std::string(path)][std::string(method)] = std::move(handler);
  }

  void run() {
    accept();
    sweep();
    const auto more = asio::make_work_guard(handlers_);
    std::jthread maker;  // its end stops it
    try {
      maker = std::jthread([this](const std::stop_token& stopped) {
        const std::stop_callback stop_handlers(stopped, [this] { handlers_.stop(); });
        handlers_.run();
      });
    } catch (const std::system_error& error) {
      throw MachineError({.what = "cannot start a thread", .got = error.code().message()});
    }
    loop_.run();
  }

  void stop() { loop_.stop(); }

 private:
  class Connection;

  void accept() {
    acceptor_.async_accept([this](error_code problem, Socket socket) {
      if (!problem) {
        if (connections_.size() >= most_connections_) close_longest_waiting();
        // All others have been asked something and are not answered yet.
        if (connections_.size() < most_connections_) open(std::move(socket));
        return accept();
      }
      // Descriptors or memory are short.
      close_longest_waiting();
      pause_.expires_after(kNoDescriptors);
      pause_.async_wait([this](error_code) { accept(); });
    });
  }

  void open(Socket socket);
  void close_longest_waiting();

  // Looks at all deadlines.
  void sweep();

  // Why a request is not for a handler. Needs its header alone.
  std::optional<HttpAnswer> refusal(const Parser::value_type& request) const;
  using Methods = std::map<std::string, Handler, std::less<>>;
  const Methods* methods_of(std::string_view path) const;
  const Handler* handler_of(std::string_view path, std::string_view method) const;

  const HttpLimits limits_;
  const std::size_t most_connections_;
  std::map<std::string, Methods, std::less<>> routes_;  // by path, by method
  asio::io_context loop_{1};
  asio::io_context handlers_{1};  // ends before loop_: what waits there holds connections
  Acceptor acceptor_{loop_};
  Timer pause_{loop_};
  Timer next_sweep_{loop_};
  std::unordered_set<std::shared_ptr<Connection>> connections_;
};

// One client: reads a request, has it answered, sends the answer, reads the next. Whatever it waits for holds a pointer
// to it.
class HttpServer::Loop::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Loop& loop, Socket socket) : loop_(loop), socket_(std::move(socket)) {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
  }

  // Whether it waits for its client, and since when.
  bool waits() const { return phase_ != Phase::kAnswering; }
  Steady::time_point since() const { return since_; }

  void begin_request() {
    parser_.emplace();
    parser_->eager(true);
    parser_->header_limit(static_cast<std::uint32_t>(loop_.limits_.header_bytes));
    parser_->body_limit(loop_.limits_.body_bytes);
    parsed_bytes_ = 0;
    told_to_continue_ = false;
    enter(Phase::kIdle, loop_.limits_.idle);
    if (received_.empty()) {
      read();
    } else {
      parse();
    }
  }

  // Ends what takes too long.
  void look_at_deadline(Steady::time_point now) {
    if (!waits() || now < deadline_) return;
    if (phase_ == Phase::kReceiving) {
      error_code ignored;
      socket_.cancel(ignored);  // read() says why
    } else {
      close();
    }
  }

  void close() {
    error_code ignored;
    socket_.close(ignored);
    loop_.connections_.erase(shared_from_this());
  }

 private:
  enum class Phase { kIdle, kReceiving, kAnswering, kSending, kLingering };

  void enter(Phase phase, std::chrono::milliseconds most) {
    phase_ = phase;
    since_ = Steady::now();
    deadline_ = since_ + most;
  }

  void read() {
    socket_.async_read_some(asio::buffer(chunk_), [self = shared_from_this()](error_code problem, std::size_t size) {
      self->handle_read(problem, size);
    });
  }

  void handle_read(error_code problem, std::size_t size) {
    if (phase_ == Phase::kLingering) return problem ? close() : read();
    if (!problem) {
      received_.append(chunk_.data(), size);
      return parse();
    }
    if (phase_ != Phase::kReceiving) return close();
    if (problem == asio::error::eof) return refuse(http::status::bad_request);
    if (problem == asio::error::operation_aborted && socket_.is_open()) return refuse(http::status::request_timeout);
    close();
  }

  void parse() {
    if (phase_ == Phase::kIdle) enter(Phase::kReceiving, loop_.limits_.request);
    error_code problem;
    const std::size_t used = parser_->put(asio::buffer(received_), problem);
    received_.erase(0, used);
    parsed_bytes_ += used;
    if (problem && problem != http::error::need_more) return refuse(status_of(problem));
    const std::size_t bytes = parsed_bytes_ + (parser_->is_done() ? 0 : received_.size());
    if (!parser_->is_header_done()) {
      if (bytes > loop_.limits_.header_bytes) return refuse(http::status::request_header_fields_too_large);
      return read();
    }
    if (auto refusal = loop_.refusal(parser_->get())) return send(std::move(*refusal), parser_->is_done());
    if (parser_->is_done()) return answer();
    if (bytes > loop_.limits_.header_bytes + kChunkOverhead * loop_.limits_.body_bytes) {
      return refuse(http::status::payload_too_large);
    }
    if (told_to_continue_ || !boost::beast::iequals(parser_->get()[http::field::expect], "100-continue")) return read();
    told_to_continue_ = true;
    static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
    asio::async_write(socket_, asio::buffer(kContinue), [self = shared_from_this()](error_code failure, std::size_t) {
      failure ? self->close() : self->read();
    });
  }

  // Has the request answered by the other thread.
  void answer() {
    phase_ = Phase::kAnswering;
    Parser::value_type message = parser_->release();
    const std::string_view target(message.target().data(), message.target().size());
    const std::size_t mark = target.find('?');
    HttpRequest request = {.method = std::string(message.method_string()),
                           .path = std::string(target.substr(0, mark)),
                           .query = std::string(mark == std::string_view::npos ? "" : target.substr(mark + 1)),
                           .body = std::move(message.body())};
    asio::post(loop_.handlers_, [self = shared_from_this(), request = std::move(request)]() mutable {
      HttpAnswer answer;
      try {
        answer = self->loop_.ask(request);
      } catch (const std::bad_alloc&) {
        answer = text_answer(static_cast<int>(http::status::internal_server_error), "out of memory");
      } catch (const std::exception& error) {
        answer = text_answer(static_cast<int>(http::status::internal_server_error), error.what());
      }
      Loop& loop = self->loop_;
      asio::post(loop.loop_, [connection = std::move(self), answer = std::move(answer)]() mutable {
        connection->send(std::move(answer), true);
      });
    });
  }

  // The client may still be sending: what it says is not read any more.
  void refuse(http::status status) { send(refused(status), false); }

  // may_stay: the request has been read to its end.
  void send(HttpAnswer answer, bool may_stay) {
    const bool http_1_1 = !may_stay || parser_->get().version() >= 11;
    stays_ = may_stay && parser_->keep_alive();
    static const auto kNothing = std::make_shared<const std::string>();
    body_ = answer.body ? answer.body : kNothing;
    const auto reason = http::obsolete_reason(static_cast<http::status>(answer.status));
    head_ = fmt::format(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
        "X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n{}{}\r\n",
        answer.status, std::string_view(reason.data(), reason.size()), answer.type, body_->size(),
        answer.allow.empty() ? "" : fmt::format("Allow: {}\r\n", answer.allow),
        !stays_    ? "Connection: close\r\n"
        : http_1_1 ? ""
                   : "Connection: keep-alive\r\n");
    if (parser_->get().method() == http::verb::head) body_ = kNothing;
    sent_bytes_ = 0;
    enter(Phase::kSending, std::min(loop_.limits_.idle, loop_.limits_.answer));
    write();
  }

  void write() {
    const std::size_t of_head = std::min(sent_bytes_, head_.size());
    const std::array<asio::const_buffer, 2> left = {asio::buffer(head_) + of_head,
                                                    asio::buffer(*body_) + (sent_bytes_ - of_head)};
    socket_.async_write_some(
        left, [self = shared_from_this()](error_code problem, std::size_t size) { self->handle_write(problem, size); });
  }

  void handle_write(error_code problem, std::size_t size) {
    if (problem) return close();
    sent_bytes_ += size;
    if (sent_bytes_ < head_.size() + body_->size()) {
      deadline_ = std::min(Steady::now() + loop_.limits_.idle, since_ + loop_.limits_.answer);
      return write();
    }
    body_.reset();
    if (stays_) return begin_request();
    // Closing at once could take the answer from a client that is still sending.
    error_code ignored;
    socket_.shutdown(Socket::shutdown_send, ignored);
    enter(Phase::kLingering, kLinger);
    read();
  }

  Loop& loop_;
  Socket socket_;
  Phase phase_ = Phase::kIdle;
  Steady::time_point since_;     // when it began to wait for the client: for a request, or for the answer to be taken
  Steady::time_point deadline_;  // of the phase
  std::array<char, kReadBytes> chunk_;
  std::string received_;  // not parsed yet
  std::optional<Parser> parser_;
  std::size_t parsed_bytes_ = 0;  // of the request
  bool told_to_continue_ = false;
  std::string head_;
  std::shared_ptr<const std::string> body_;
  std::size_t sent_bytes_ = 0;  // of both
  bool stays_ = false;
};

void HttpServer::Loop::open(Socket socket) {
  (*connections_.insert(std::make_shared<Connection>(*this, std::move(socket))).first)->begin_request();
}

void HttpServer::Loop::close_longest_waiting() {
  std::shared_ptr<Connection> longest;
  for (const auto& connection : connections_) {
    if (connection->waits() && (!longest || connection->since() < longest->since())) longest = connection;
  }
  if (longest) longest->close();
}

void HttpServer::Loop::sweep() {
  const std::vector<std::shared_ptr<Connection>> all(connections_.begin(), connections_.end());
  for (const auto& connection : all) connection->look_at_deadline(Steady::now());
  next_sweep_.expires_after(kSweep);
  next_sweep_.async_wait([this](error_code) { sweep(); });
}

std::optional<HttpAnswer> HttpServer::Loop::refusal(const Parser::value_type& request) const {
  const auto view = [](boost::beast::string_view text) { return std::string_view(text.data(), text.size()); };
  if (request.count(http::field::host) != 1) return refused(http::status::bad_request);
  const std::string_view host = view(request[http::field::host]);
  const std::string_view origin = view(request[http::field::origin]);
  if (!is_this_machine(host) || (!origin.empty() && origin != fmt::format("http://{}", host))) {
    return refused(http::status::forbidden);
  }
  const std::string_view path = view(request.target()).substr(0, request.target().find('?'));
  const Methods* const methods = methods_of(path);
  if (methods == nullptr) return refused(http::status::not_found);
  if (handler_of(path, view(request.method_string())) != nullptr) return std::nullopt;
  HttpAnswer answer = refused(http::status::method_not_allowed);
  for (const auto& [method, handler] : *methods) {
    answer.allow += (answer.allow.empty() ? "" : ", ") + method + (method == "GET" ? ", HEAD" : "");
  }
  return answer;
}

// Of the path itself, else of all in its folder, or in the folder around that.
const HttpServer::Loop::Methods* HttpServer::Loop::methods_of(std::string_view path) const {
  auto route = routes_.find(path);
  for (std::size_t folder = path.rfind('/'); route == routes_.end() && folder != std::string_view::npos && folder > 0;
       folder = path.rfind('/', folder - 1)) {
    if (folder + 1 < path.size()) route = routes_.find(std::string(path.substr(0, folder)) + "/*");
  }
  return route == routes_.end() ? nullptr : &route->second;
}

const HttpServer::Handler* HttpServer::Loop::handler_of(std::string_view path, std::string_view method) const {
  const Methods* const methods = methods_of(path);
  if (methods == nullptr) return nullptr;
  const auto found = methods->find(method == "HEAD" ? "GET" : method);
  return found == methods->end() ? nullptr : &found->second;
}

HttpServer::HttpServer(int port, const HttpLimits& limits) : loop_(std::make_unique<Loop>(port, limits)) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return loop_->port();
}

void HttpServer::on(std::string_view method, std::string_view path, Handler handler) {
  loop_->on(method, path, std::move(handler));
}

HttpAnswer HttpServer::ask(const HttpRequest& request) const {
  return loop_->ask(request);
}

void HttpServer::run() {
  loop_->run();
}

void HttpServer::stop() {
  loop_->stop();
}

}  // namespace graphdrl
