// HTTP for those who ask in JSON: each request is handed whole to one function. With
// http_server.cpp the door to the library's server. Whoever asks may be hostile: head and body of a
// request are bounded in bytes and in time, and what is refused is answered in the caller's words.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/http_reply.h"

namespace isoline {

struct HttpLimits {
  std::size_t head_bytes = 64 << 10, body_bytes = 1 << 20;
  double idle_seconds = 10, request_seconds = 60;  // without a byte; from its first to its last
  std::size_t connections = 16;                    // at a time; others wait
};

struct HttpRoute {
  std::string method, path;  // "GET" or "POST", and what of a regular expression stands for itself
  // Called from several threads. An exception is answered by `refusal(500, what)`.
  std::function<HttpReply(const std::string& body)> answer;
};

class HttpServer {
 public:
  // What stands in the reply that refuses a request, by status: 400 what is no request, 404 an
  // unknown path, 413 a body too large, 500 an exception.
  using Refusal = std::function<std::string(int status, const std::string& reason)>;

  // Bound when made, to any port where it is 0. UsageError where that cannot be.
  HttpServer(const std::string& host, int port, const std::vector<HttpRoute>& routes,
             Refusal refusal, const HttpLimits& limits);
  ~HttpServer();  // stops
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  std::string url() const;
  void start();  // listens in threads of its own, which no signal reaches
  void stop();   // answers what was asked and lets every connection go

 private:
  class Connections;
  std::unique_ptr<Connections> connections_;
};

}  // namespace isoline
