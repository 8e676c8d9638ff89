// What an HTTP server answers, and what its caller gets.
#pragma once

#include <string>

namespace isoline {

struct HttpReply {
  int status = 200;
  std::string body = {};  // JSON
};

}  // namespace isoline
