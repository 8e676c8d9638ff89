// isoline serve PROBLEM...: offers problems as models of UM-Bridge, until it is stopped.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "benchmarks/cli/numbers.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "benchmarks/serve/serve.h"
#include "core/errors.h"
#include "core/spec.h"
#include "core/text.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

using reports::counted;

namespace {

constexpr WholeLaw kPorts{0, 65535};

// As whoever starts models of UM-Bridge says which port is wanted; 0, any, where nobody does.
int port_of_environment() {
  const char* const port = std::getenv("PORT");
  if (port == nullptr || *port == '\0') return 0;
  return static_cast<int>(read_whole("PORT", port, kPorts));
}

}  // namespace

int serve_verb(const ServeArguments& given, Session& session) {
  const Catalog& catalog = session.catalog();
  require(given.client.empty() || !given.folder.empty(),
          "--client names whoever asks in a record, and needs --record DIR");
  ServeOptions options{.seed = given.seed,
                       .host = given.host,
                       .port = given.port >= 0 ? given.port : port_of_environment(),
                       .folder = given.folder,
                       .client = given.client,
                       .command = session.command()};
  for (const std::string& text : given.problems)
    for (const Spec& spec : parse_specs(text))
      options.problems.push_back(complete_problem(catalog, spec));
  const auto listening = [](const std::string& url, const std::vector<std::string>& models) {
    say(stdout, fmt::format("serving {} at {}\n", counted(models.size(), "model"), url));
    std::fflush(stdout);
  };
  const Served served = serve(catalog, options, listening);
  for (const std::string& remark : served.remarks) say(stderr, "isoline: " + remark + "\n");
  for (const std::string& title : served.records) say(stdout, "recorded " + title + "\n");
  return kGood;
}

}  // namespace isoline::benchmarks
