// What programs said of themselves: each is started once for it, and not again while its command
// and its files stay as they are.
#pragma once

#include <map>
#include <string>

#include "core/foreign/handshake.h"

namespace isoline {

// How a command is started by the door of child processes: where it finds our clients.
ChildProgram::Start door_to(const std::string& command);

// The part of a component's Foreign that its command tells.
Foreign foreign_of_command(const std::string& command);

template <class Handshake>
class Introductions {
 public:
  template <class Greet>
  const Handshake& of(const std::string& command, const Greet& greet) {
    const ChildProgram::Start start = door_to(command);
    const Foreign own = foreign_of_command(command);
    const std::string key = own.digest + " " + command;
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    Line line(start);
    Handshake said = greet(line);
    said.foreign.door = own.door;
    said.foreign.command = own.command;
    said.foreign.digest = own.digest;
    return known_[key] = std::move(said);
  }

 private:
  std::map<std::string, Handshake> known_;
};

}  // namespace isoline
