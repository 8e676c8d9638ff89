// Serves problems by UM-Bridge until this process is asked to end, and keeps what was asked.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"

namespace isoline::benchmarks {

struct ServeOptions {
  std::vector<Component> problems;
  std::uint64_t seed = 0;
  std::string host = "127.0.0.1";
  int port = 0;              // 0: any that is free
  std::string folder;        // for records; empty: nothing is kept
  std::string client;        // what tables call whoever asks
  std::string command = "";  // for the records
};

// What came of it, for who stopped it.
struct Served {
  std::vector<std::string> records;  // titles
  std::vector<std::string> remarks;
};

// `listening` is told the address once it can be asked there, and the models.
Served serve(const Catalog& catalog, const ServeOptions& options,
             const std::function<void(const std::string& url,
                                      const std::vector<std::string>& models)>& listening);

}  // namespace isoline::benchmarks
