// A server of UM-Bridge that is started for one problem and ends with it: it is told its port by
// PORT, and counts as ready once it answers what models it has.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "core/foreign/child.h"

namespace isoline::problems {

class BridgeServer {
 public:
  // UsageError, with its last words, where it does not answer within so many seconds.
  BridgeServer(const std::string& command, double seconds);
  ~BridgeServer();
  BridgeServer(const BridgeServer&) = delete;
  BridgeServer& operator=(const BridgeServer&) = delete;

  const std::string& url() const { return url_; }
  // "it left with exit code 1: ImportError …"
  std::string end_in_words();

 private:
  BridgeServer(const std::string& command, int port, double seconds);
  void await(double seconds);
  void drain();
  int output();
  bool has_ended();

  const std::string url_;
  std::mutex mutex_;  // of what both threads ask of it
  ChildProgram child_;
  std::atomic<bool> is_over_ = false;
  std::thread draining_;  // a server that prints much would else wait for a reader
};

}  // namespace isoline::problems
