// The door to cpp-httplib's client.
#include "core/http_client.h"

#include <fmt/format.h>
#include <httplib.h>

#include <charconv>
#include <chrono>
#include <csignal>
#include <utility>

#include "core/clock.h"
#include "core/errors.h"
#include "core/without_signals.h"

namespace isoline {
namespace {

constexpr const char* kJson = "application/json";

struct Place {
  std::string host, prefix;
  int port = 80;
};

// "http://host:port/prefix"
Place place_of(const std::string& url) {
  const auto refuse = [&] {
    return fmt::format("a model's url is as http://127.0.0.1:4242, got '{}'", url);
  };
  constexpr std::string_view kScheme = "http://";
  require(url.starts_with(kScheme), refuse);
  std::string_view rest = std::string_view(url).substr(kScheme.size());
  Place place;
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  place.prefix = rest.substr(slash);
  while (place.prefix.ends_with('/')) place.prefix.pop_back();
  rest = rest.substr(0, slash);
  const std::size_t behind = rest.starts_with('[') ? rest.find(']') : 0;
  require(behind != std::string_view::npos, refuse);
  const std::size_t colon = rest.find(':', behind);
  place.host = rest.substr(0, colon);
  if (place.host.starts_with('[')) place.host = place.host.substr(1, place.host.size() - 2);
  require(!place.host.empty(), refuse);
  if (colon == std::string_view::npos) return place;
  const std::string_view digits = rest.substr(colon + 1);
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), place.port);
  constexpr int kMostPort = 65535;
  require(error == std::errc() && end == digits.data() + digits.size() && place.port > 0 &&
              place.port <= kMostPort,
          refuse);
  return place;
}

std::string words_of(httplib::Error error, double seconds, double waited) {
  switch (error) {
    case httplib::Error::Connection:
    case httplib::Error::ConnectionTimeout:
      return "nobody listens there";
    case httplib::Error::Canceled:
      return "its answer is longer than any that was asked for";
    default:
      return waited >= seconds ? fmt::format("it gave no answer within {:g} s", seconds)
                               : "the connection broke before an answer came";
  }
}

// A connection that the other side has closed would end this process by SIGPIPE.
class WithoutPipeSignal {
 public:
  WithoutPipeSignal() : held_(pipe_signal()) {}
  ~WithoutPipeSignal() {
    const sigset_t pipe = pipe_signal();
    const timespec at_once{};
    while (sigtimedwait(&pipe, nullptr, &at_once) > 0) {
    }
  }

 private:
  static sigset_t pipe_signal() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    return pipe;
  }
  WithoutSignals held_;
};

}  // namespace

class HttpClient::Connection {
 public:
  Connection(std::string url, double seconds, std::size_t most_bytes)
      : url_(std::move(url)),
        place_(place_of(url_)),
        seconds_(seconds),
        most_bytes_(most_bytes),
        client_(place_.host, place_.port) {
    constexpr time_t kConnecting = 10;
    client_.set_connection_timeout(kConnecting);
    client_.set_read_timeout(std::chrono::duration<double>(seconds));
    client_.set_write_timeout(std::chrono::duration<double>(seconds));
    client_.set_keep_alive(true);
    client_.set_tcp_nodelay(true);
  }
  const std::string& url() const { return url_; }

  // A kept connection may have been closed by the other side just now: it is asked once more then,
  // on a new one.
  HttpReply ask(const char* method, const std::string& path, const std::string& body) {
    const WithoutPipeSignal held;
    const bool was_kept = std::exchange(is_kept_, true);
    const std::int64_t begun = monotonic_nanoseconds();
    const auto waited = [&] { return 1e-9 * static_cast<double>(monotonic_nanoseconds() - begun); };
    HttpReply reply;
    httplib::Error error = send(method, path, body, reply);
    const bool is_broken = error == httplib::Error::Read || error == httplib::Error::Write;
    if (was_kept && is_broken && waited() < seconds_ / 2) error = send(method, path, body, reply);
    if (error != httplib::Error::Success)
      throw HttpFailure(fmt::format("{}{}: {}", url_, path, words_of(error, seconds_, waited())));
    return reply;
  }

 private:
  httplib::Error send(const char* method, const std::string& path, const std::string& body,
                      HttpReply& reply) {
    reply.body.clear();
    httplib::Request request;
    request.method = method;
    request.path = place_.prefix + path;
    if (request.method == "POST") {
      request.set_header("Content-Type", kJson);
      request.body = body;
    }
    request.content_receiver = [&](const char* bytes, std::size_t size, auto, auto) {
      if (size > most_bytes_ - reply.body.size()) return false;
      reply.body.append(bytes, size);
      return true;
    };
    const httplib::Result result = client_.send(request);
    if (result) reply.status = result->status;
    return result.error();
  }

  const std::string url_;
  const Place place_;
  const double seconds_;
  const std::size_t most_bytes_;
  bool is_kept_ = false;
  httplib::Client client_;
};

HttpClient::HttpClient(const std::string& url, double seconds, std::size_t most_bytes)
    : connection_(std::make_unique<Connection>(url, seconds, most_bytes)) {}
HttpClient::~HttpClient() = default;
const std::string& HttpClient::url() const { return connection_->url(); }
HttpReply HttpClient::get(const std::string& path) { return connection_->ask("GET", path, ""); }
HttpReply HttpClient::post(const std::string& path, const std::string& body) {
  return connection_->ask("POST", path, body);
}

}  // namespace isoline
