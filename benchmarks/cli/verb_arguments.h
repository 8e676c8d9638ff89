// What the arguments of a verb are, declared without the library that parses them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/cli/numbers.h"
#include "benchmarks/cli/verbs.h"

namespace isoline::benchmarks {

// One argument; whatever is said of it returns it again.
class Argument {
 public:
  virtual ~Argument() = default;
  virtual const Argument& required() const = 0;
  virtual const Argument& shown() const = 0;  // its default, in the help
  virtual const Argument& shown(const std::string& standard) const = 0;
  virtual const Argument& one_of(const std::vector<std::string>& names) const = 0;
  virtual const Argument& between_commas() const = 0;
  virtual const Argument& one_each() const = 0;  // value, each time that it is given
  virtual const Argument& joined() const = 0;    // by commas, where it is given more than once
  virtual const Argument& needs(const Argument& other) const = 0;
  virtual const Argument& excludes(const Argument& other) const = 0;
};

// Those of one verb. A name without dashes is that of a place.
class VerbArguments {
 public:
  virtual ~VerbArguments() = default;
  virtual const Argument& text(const char* name, std::string& value, const char* about) = 0;
  virtual const Argument& texts(const char* name, std::vector<std::string>& values,
                                const char* about) = 0;
  virtual const Argument& flag(const char* name, bool& value, const char* about) = 0;
  // A default that the law allows stands in the help.
  virtual void whole(const char* name, int& value, const char* about, WholeLaw law = {}) = 0;
  virtual void whole(const char* name, std::int64_t& value, const char* about,
                     WholeLaw law = {}) = 0;
  virtual const Argument& real(const char* name, double& value, const Range& range,
                               const char* about) = 0;
  virtual void seed(const char* name, std::uint64_t& value, const char* about) = 0;
  virtual void time(const char* name, double& seconds, const char* about) = 0;
  virtual void memory(const char* name, std::int64_t& bytes, const char* about) = 0;
};

void declare(VerbArguments& verb, RunArguments& given);
void declare(VerbArguments& verb, PlanArguments& given);
void declare(VerbArguments& verb, ReportArguments& given);
void declare(VerbArguments& verb, CompareArguments& given);
void declare(VerbArguments& verb, BaselineArguments& given);
void declare(VerbArguments& verb, ReplayArguments& given);
void declare(VerbArguments& verb, MergeArguments& given);
void declare(VerbArguments& verb, SubmitArguments& given);
void declare(VerbArguments& verb, StatusArguments& given);
void declare(VerbArguments& verb, BestArguments& given);
void declare(VerbArguments& verb, ClaimArguments& given);
void declare(VerbArguments& verb, ListArguments& given);
void declare(VerbArguments& verb, DescribeArguments& given);
void declare(VerbArguments& verb, CheckArguments& given);
void declare(VerbArguments& verb, AuditArguments& given);
void declare(VerbArguments& verb, ValidateArguments& given);
void declare(VerbArguments& verb, TuneArguments& given);
void declare(VerbArguments& verb, TrainArguments& given);
void declare(VerbArguments& verb, NewArguments& given);
void declare(VerbArguments& verb, InferArguments& given);
void declare(VerbArguments& verb, ExportArguments& given);
void declare(VerbArguments& verb, CompletionArguments& given);

}  // namespace isoline::benchmarks
