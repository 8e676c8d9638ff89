// Servers started, awaited and heard.
#include "problems/physics/bridge_server.h"

#include <fmt/format.h>
#include <poll.h>

#include "core/bridge_answers.h"
#include "core/clock.h"
#include "core/errors.h"
#include "core/http_client.h"
#include "core/http_server.h"
#include "core/without_signals.h"

namespace isoline::problems {
namespace {

constexpr const char* kHost = "127.0.0.1";

// That nobody listens at: bound and let go.
int free_port() { return HttpServer(kHost, 0, {}, {}, {}).port(); }

}  // namespace

BridgeServer::BridgeServer(const std::string& command, double seconds)
    : BridgeServer(command, free_port(), seconds) {}

BridgeServer::BridgeServer(const std::string& command, int port, double seconds)
    : url_(fmt::format("http://{}:{}", kHost, port)),
      child_({.command = command, .environment = {{"PORT", std::to_string(port)}}}) {
  const WithoutSignals held(all_signals());
  draining_ = std::thread([this] { drain(); });
  try {
    await(seconds);
  } catch (...) {
    is_over_ = true;
    draining_.join();
    throw;
  }
}

BridgeServer::~BridgeServer() {
  is_over_ = true;
  if (draining_.joinable()) draining_.join();
}

void BridgeServer::drain() {
  constexpr int kMilliseconds = 50;  // after which the end of the problem is seen
  while (!is_over_) {
    pollfd waiting{output(), POLLIN, 0};  // −1 once it is closed, which is no event
    ::poll(&waiting, 1, kMilliseconds);
    const std::lock_guard lock(mutex_);
    child_.drain();
  }
}

int BridgeServer::output() {
  const std::lock_guard lock(mutex_);
  return child_.output();
}

bool BridgeServer::has_ended() {
  const std::lock_guard lock(mutex_);
  return child_.has_ended();
}

std::string BridgeServer::end_in_words() {
  const std::lock_guard lock(mutex_);
  const std::string words = child_.last_words();
  return child_.end_in_words() + (words.empty() ? "" : ": " + words);
}

void BridgeServer::await(double seconds) {
  constexpr int kPauseMilliseconds = 5;
  constexpr std::size_t kMostInfo = 1 << 20;
  const auto left = [last = monotonic_nanoseconds() + static_cast<std::int64_t>(seconds * 1e9)] {
    return 1e-9 * static_cast<double>(last - monotonic_nanoseconds());
  };
  while (left() > 0 && !has_ended()) {
    try {
      HttpClient(url_, left(), kMostInfo).get("/Info");
      return;
    } catch (const HttpFailure&) {  // not yet
      ::poll(nullptr, 0, kPauseMilliseconds);
    }
  }
  throw UsageError(fmt::format("'{}' did not answer at port {} within {:g} s; {}", child_.command(),
                               url_.substr(url_.rfind(':') + 1), seconds, end_in_words()));
}

}  // namespace isoline::problems
