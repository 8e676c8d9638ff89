// The paths of UM-Bridge over all models that are served: a body in, a reply out, whatever the body
// is. What is refused is refused in the protocol's own error object.
#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "benchmarks/serve/served_models.h"
#include "core/http_server.h"

namespace isoline::benchmarks {

class BridgeService {
 public:
  // The runs outlive it. UsageError where two models have one name.
  explicit BridgeService(std::deque<ServedRun>& runs);

  const std::vector<std::string>& models() const { return names_; }
  std::size_t most_bytes() const;   // that a request of the largest model may take
  std::vector<HttpRoute> routes();  // "GET /Info", "POST /Evaluate", …
  HttpReply answer(const std::string& path, const std::string& body);
  static std::string refusal(int status, const std::string& reason);

 private:
  struct Model {
    ServedModels* of;
    View view;
  };
  const Model& at(const std::string& name) const;
  std::string answered(const std::string& path, const std::string& body);

  std::deque<ServedModels> served_;  // they stay where they are
  std::map<std::string, Model> models_;
  std::vector<std::string> names_;  // in the order of the command line
  std::mutex computing_;            // plans of transforms and the like are shared by problems
};

}  // namespace isoline::benchmarks
