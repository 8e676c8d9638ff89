// What the verbs share: the catalog, made when first needed, with what the libraries of --plugin
// bring, and the command that records name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace isoline::benchmarks {

struct Catalog;

class Session {
 public:
  Session(std::string command, std::function<Catalog()> make);
  void set_plugins(const std::vector<std::string>& paths) { plugins_ = paths; }
  const Catalog& catalog();
  const std::string& command() const { return command_; }

 private:
  std::string command_;
  std::function<Catalog()> make_;
  std::vector<std::string> plugins_;
  std::shared_ptr<const Catalog> catalog_;
};

}  // namespace isoline::benchmarks
