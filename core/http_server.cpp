// The door to cpp-httplib's server. The library's own socket waits for each byte anew and takes
// heads and chunks of any length: connections read through BoundedSocket instead.
#include "core/http_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <thread>

#include "core/bounded_socket.h"
#include "core/errors.h"
#include "core/without_signals.h"

namespace isoline {
namespace {

constexpr const char* kJson = "application/json";
constexpr int kTooLong = 413;
constexpr std::size_t kMostDrained = std::size_t{2} << 30;  // bytes of a body that is refused
constexpr double kKeptSeconds = 60;   // that a connection may be silent between two requests
constexpr double kStopSeconds = 0.1;  // after which a silent connection sees that all is over

// What the library reads and writes through.
class BoundedStream final : public httplib::Stream {
 public:
  explicit BoundedStream(BoundedSocket& socket) : socket_(socket) {}
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* out, std::size_t size) override { return socket_.read(out, size); }
  ssize_t write(const char* bytes, std::size_t size) override {
    return socket_.write({bytes, size}) ? static_cast<ssize_t>(size) : -1;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_.descriptor(); }

 private:
  BoundedSocket& socket_;
};

// Bytes of the body that its head announces; of chunks, which announce none, twice what a body may
// have and a head's worth of their lengths.
std::size_t announced(const httplib::Request& request, const HttpLimits& limits) {
  if (request.has_header("Transfer-Encoding")) return 2 * limits.body_bytes + limits.head_bytes;
  const std::string length = request.get_header_value("Content-Length");
  std::size_t bytes = 0;
  const auto [end, error] = std::from_chars(length.data(), length.data() + length.size(), bytes);
  if (error == std::errc::result_out_of_range) return kMostDrained;
  return std::min(bytes, kMostDrained);
}

}  // namespace

class HttpServer::Connections final : public httplib::Server {
 public:
  Connections(std::string host, int port, const std::vector<HttpRoute>& routes, Refusal refusal,
              const HttpLimits& limits)
      : host_(std::move(host)), refusal_(std::move(refusal)), limits_(limits) {
    set_payload_max_length(limits.body_bytes);
    set_tcp_nodelay(true);
    new_task_queue = [count = limits.connections] { return new httplib::ThreadPool(count); };
    for (const HttpRoute& route : routes) add(route);
    answer_what_is_no_request();
    port_ = port == 0 ? bind_to_any_port(host_) : bind_to_port(host_, port) ? port : -1;
    require(port_ > 0,
            [&] { return fmt::format("nothing can listen at {}, port {}", host_, port); });
  }
  int port() const { return port_; }
  const std::string& host() const { return host_; }

  void start() {
    const WithoutSignals held(all_signals());
    listening_ = std::thread([this] { listen_after_bind(); });
  }
  void end() {
    is_over_ = true;
    if (!listening_.joinable()) {
      if (const socket_t bound = svr_sock_.exchange(INVALID_SOCKET); bound != INVALID_SOCKET)
        ::close(bound);
      return;
    }
    while (!is_running() && svr_sock_ != INVALID_SOCKET) std::this_thread::yield();
    stop();
    listening_.join();
  }

 private:
  void add(const HttpRoute& route) {
    known_.push_back(route.method + " " + route.path);
    if (route.method == "GET")
      Get(route.path, [this, answer = route.answer](const httplib::Request&, auto& reply) {
        give(reply, answer, "");
      });
    else
      Post(route.path, [this, answer = route.answer](const httplib::Request&, auto& reply,
                                                     const httplib::ContentReader& read) {
        std::string body;
        bool is_too_long = false;
        const bool is_whole = read([&](const char* bytes, std::size_t size) {
          is_too_long = size > limits_.body_bytes - body.size();
          if (!is_too_long) body.append(bytes, size);
          return !is_too_long;
        });
        if (is_whole)
          give(reply, answer, body);
        else if (is_too_long || reply.status == kTooLong)
          refuse(reply, kTooLong, "");
        else
          refuse(reply, 400, "the body did not arrive whole");
      });
  }

  void answer_what_is_no_request() {
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& reply) {
      const std::string method = request.method == "HEAD" ? "GET" : request.method;
      const bool is_known = std::ranges::find(known_, method + " " + request.path) != known_.end();
      const bool is_form = request.get_header_value("Content-Type").starts_with("multipart/");
      if (is_known && !is_form) return HandlerResponse::Unhandled;
      refuse(reply, is_known ? 400 : 404, is_known ? "a body is JSON, not a form" : "");
      return HandlerResponse::Handled;
    });
    set_error_handler([this](const httplib::Request&, httplib::Response& reply) {
      if (reply.body.empty()) refuse(reply, reply.status, "");
    });
  }

  void give(httplib::Response& reply, const std::function<HttpReply(const std::string&)>& answer,
            const std::string& body) const {
    try {
      HttpReply made = answer(body);
      reply.status = made.status;
      reply.body = std::move(made.body);
      reply.set_header("Content-Type", kJson);
    } catch (const std::exception& error) {
      refuse(reply, 500, error.what());
    }
  }

  void refuse(httplib::Response& reply, int status, const std::string& reason) const {
    has_refused_ = true;
    reply.status = status;
    reply.body = refusal_(status, reason);
    reply.set_header("Content-Type", kJson);
    reply.set_header("Connection", "close");
  }

  // Requests of one connection, one after another, until either side has had enough.
  bool process_and_close_socket(socket_t descriptor) override {
    BoundedSocket socket(descriptor);
    BoundedStream stream(socket);
    while (is_asked(socket) && process_one(socket, stream)) {
    }
    socket.close_gently();
    return true;
  }

  bool is_asked(BoundedSocket& socket) const {
    constexpr int kLooks = static_cast<int>(kKeptSeconds / kStopSeconds);
    for (int look = 0; look < kLooks && !is_over_; ++look)
      if (socket.can_be_read(kStopSeconds)) return true;
    return false;
  }

  // Whether the connection may go on. One that was refused may not, nor one whose body was not read
  // to its end: what is left of it would be taken for a request.
  bool process_one(BoundedSocket& socket, BoundedStream& stream) {
    socket.allow(limits_.head_bytes, limits_.request_seconds, limits_.idle_seconds);
    bool is_closed = false, is_chunked = false;
    has_refused_ = false;
    const auto read_head = [&](httplib::Request& request) {
      request.headers.erase("Accept-Encoding");  // to compress takes longer than to send
      request.ranges.clear();
      is_chunked = request.has_header("Transfer-Encoding");
      socket.allow_bytes(announced(request, limits_));
    };
    const bool is_good = process_request(stream, false, is_closed, read_head);
    return socket.flush() && is_good && !has_refused_ && !is_closed && !is_chunked &&
           socket.bytes_left() == 0;
  }

  // Of the request that a thread answers: the library tells nobody what it answered.
  inline static thread_local bool has_refused_ = false;

  const std::string host_;
  const Refusal refusal_;
  const HttpLimits limits_;
  std::vector<std::string> known_;  // "POST /Evaluate"
  int port_ = -1;
  std::atomic<bool> is_over_ = false;
  std::thread listening_;
};

HttpServer::HttpServer(const std::string& host, int port, const std::vector<HttpRoute>& routes,
                       Refusal refusal, const HttpLimits& limits)
    : connections_(std::make_unique<Connections>(host, port, routes, std::move(refusal), limits)) {}
HttpServer::~HttpServer() { stop(); }
int HttpServer::port() const { return connections_->port(); }
std::string HttpServer::url() const {
  const std::string& host = connections_->host();
  const bool is_v6 = host.find(':') != std::string::npos;
  return fmt::format("http://{}:{}", is_v6 ? "[" + host + "]" : host, port());
}
void HttpServer::start() { connections_->start(); }
void HttpServer::stop() { connections_->end(); }

}  // namespace isoline
