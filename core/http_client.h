// A caller of HTTP that keeps its connection. With http_client.cpp the door to the library's
// client.
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/http_reply.h"

namespace isoline {

// No answer: nobody listens, the connection broke, the time is over, it is too long.
struct HttpFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class HttpClient {
 public:
  // Of "http://host:port", a path behind it or not. UsageError where it is another. `seconds`: that
  // an answer may be waited for.
  HttpClient(const std::string& url, double seconds, std::size_t most_bytes);
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  const std::string& url() const;
  HttpReply get(const std::string& path);
  HttpReply post(const std::string& path, const std::string& body);

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace isoline
