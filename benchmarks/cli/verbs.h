// The verbs of the command line: what each is given, and a plain function that does it and returns
// the exit code. verb_arguments.cpp says how the arguments are written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/status.h"

namespace isoline::benchmarks {

class Session;

struct RunArguments {
  std::string suite, problem, optimizer, seeds, out, rates = "builtin";
  std::string shard;                                        // "3/16", "auto"; empty: the whole
  std::int64_t iterations = 0, work = 0, memory_bytes = 0;  // 0: as the suite or the runner has it
  double seconds = 0, target = -1;                          // 0, −1: as the suite has it
  std::vector<std::string> retry;                           // statuses
  int jobs = 0, threads = 0, repeat = 1;                    // 0: one a core; as the suite has it
  bool force = false, reuse = false, is_dry = false, lists_all = false, exclusive = false;
  bool no_report = false, quiet = false, allow_large = false, keeps_output = false;
  bool keeps_fields = false;
  bool keeps_spectra = false;
  bool in_process = false;
  std::vector<std::string> plugins;  // libraries, which join the registries first
};
int run_verb(const RunArguments& given, Session& session);

struct PlanArguments {
  RunArguments run;
  std::vector<std::string> earlier;  // result folders
  int shards = 0;                    // 0: the whole
  bool as_json = false;
};
int plan_verb(const PlanArguments& given, Session& session);

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out, by = "work";
  double tolerance = 1e-6;
  bool opens = false;
};
int report_verb(const ReportArguments& given, Session& session);
std::string format_names();  // of what it writes: "index.html, report.csv, …"

struct CompareArguments {
  std::string before, after;
  double tolerance = -1, noise = -1;  // −1: bit for bit; the standard band
  std::vector<std::string> timed;
  std::string allowed;  // a list of cells that NEW may lack
  bool is_common_only = false, as_markdown = false, as_json = false, lists_all = false;
};
int compare_verb(const CompareArguments& given, Session& session);

struct BaselineArguments {
  std::vector<std::string> folders;
  std::string out;
  int perturbations = 2, jobs = 0;
  std::vector<std::string> plugins;
};
int baseline_verb(const BaselineArguments& given, Session& session);

struct ReplayArguments {
  std::vector<std::string> records;
  std::int64_t memory_bytes = 0;  // 0: as the runner has it
  std::vector<std::string> plugins;
};
int replay_verb(const ReplayArguments& given, Session& session);

struct MergeArguments {
  std::vector<std::string> folders;
  std::string out;
};
int merge_verb(const MergeArguments& given, Session& session);

struct SubmitArguments {
  std::vector<std::string> run;      // what stands after `isoline run`
  std::vector<std::string> options;  // of sbatch
  std::string partition;
  double seconds = 0, least_seconds = 300;  // 0: the partition's limit
  int tasks = 16;
  bool is_slurm = false, is_agreed = false;
};
int submit_verb(const SubmitArguments& given, Session& session);

struct StatusArguments {
  std::string folder;
  bool as_json = false;
};
int status_verb(const StatusArguments& given, Session& session);

struct BestArguments {
  std::vector<std::string> folders;
  std::string out = "benchmarks/best.json";
};
int best_verb(const BestArguments& given, Session& session);

struct ClaimArguments {
  std::vector<std::string> names;
  std::string out = "results/claims";
  int jobs = 0;
  bool is_list = false, as_json = false, no_run = false, with_long = false, lists_all = false;
};
int claims_verb(const ClaimArguments& given, Session& session);

struct ListArguments {
  std::string kind = "all";
  bool as_json = false, names_only = false;
  std::vector<std::string> plugins;
};
int list_verb(const ListArguments& given, Session& session);

struct DescribeArguments {
  std::string name;
  bool as_json = false;
  std::vector<std::string> plugins;
};
int describe_verb(const DescribeArguments& given, Session& session);

struct CheckArguments {
  std::string spec;
  std::uint64_t seed = 0;
  bool as_json = false;
  std::vector<std::string> plugins;
};
int check_verb(const CheckArguments& given, Session& session);

struct AuditArguments {
  std::vector<std::string> names;
  std::string out;
  bool as_json = false, lists_all = false;
  std::vector<std::string> plugins;
};
int audit_verb(const AuditArguments& given, Session& session);

struct ValidateArguments {
  std::vector<std::string> paths;
};
int validate_verb(const ValidateArguments& given, Session& session);

struct TuneArguments {
  std::string problem, optimizer, suite, grid, unit = "one", seeds = "100..102";
  std::string table, folder = "results/tuning";
  std::int64_t iterations = 100'000, work = 2000;
  int jobs = 0;
  bool as_json = false, lists_all = false;
  std::vector<std::string> plugins;
};
int tune_verb(const TuneArguments& given, Session& session);

struct TrainArguments {
  std::string problem, optimizer = "sip", out;
  std::uint64_t seed = 0;
  std::int64_t iterations = 1000, memory_bytes = 0;  // 0: as a cell's
  double seconds = 0;                                // 0: no limit
  int threads = 1;
  bool quiet = false;
  std::vector<std::string> plugins;
};
int train_verb(const TrainArguments& given, Session& session);

struct NewArguments {
  std::string kind, name;
  bool is_c = false, is_python = false;  // else C++
};
int new_verb(const NewArguments& given, Session& session);

struct InferArguments {
  std::string network, input, output;
  std::int64_t memory_bytes = 0;  // 0: as a cell's
  double seconds = 600;
};
int infer_verb(const InferArguments& given, Session& session);

struct ExportArguments {
  std::vector<std::string> folders;
  std::string format = "csv", out;
};
int export_verb(const ExportArguments& given, Session& session);

struct CompletionArguments {
  std::string shell = "bash";
  std::vector<std::string> verbs;  // filled in by the command line, which knows them
};
int completion_verb(const CompletionArguments& given, Session& session);

}  // namespace isoline::benchmarks
