// SHA-256 (FIPS 180-4): digests that anybody can check with `sha256sum`, of files that travel.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace isoline {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void add(std::string_view bytes);
  std::string text();  // of all that was added, as 64 hexadecimal digits; begins anew

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string sha256(std::string_view bytes);

}  // namespace isoline
