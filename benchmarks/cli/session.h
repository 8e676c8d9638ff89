// What the verbs share: the catalog, made when first needed, and the command that records name.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace isoline::benchmarks {

struct Catalog;

class Session {
 public:
  Session(std::string command, std::function<Catalog()> make);
  const Catalog& catalog();
  const std::string& command() const { return command_; }

 private:
  std::string command_;
  std::function<Catalog()> make_;
  std::shared_ptr<const Catalog> catalog_;
};

}  // namespace isoline::benchmarks
