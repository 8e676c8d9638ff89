// A server from its first request to its last, and the records of both.
#include "benchmarks/serve/serve.h"

#include <csignal>
#include <deque>

#include "benchmarks/run/run_plan.h"
#include "benchmarks/run/sheets.h"
#include "benchmarks/serve/bridge_service.h"
#include "core/without_signals.h"

namespace isoline::benchmarks {
namespace {

// By which this process is asked to end.
sigset_t endings() {
  sigset_t all;
  sigemptyset(&all);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&all, signal);
  return all;
}

void await(const sigset_t& signals) {
  int which = 0;
  while (sigwait(&signals, &which) != 0) {
  }
}

std::vector<Request> requests_of(const Catalog& catalog, const ServeOptions& options) {
  std::vector<Request> all;
  const Component client = complete_optimizer(
      catalog, "served", OptionValues{{"client", options.client.empty() ? "?" : options.client}});
  for (const Component& problem : options.problems)
    all.push_back(named({.problem = problem, .optimizer = client, .seed = options.seed}));
  return all;
}

}  // namespace

Served serve(const Catalog& catalog, const ServeOptions& options,
             const std::function<void(const std::string& url,
                                      const std::vector<std::string>& models)>& listening) {
  const std::vector<Request> requests = requests_of(catalog, options);
  std::deque<ServedRun> runs;  // each stays where it is
  for (const Request& request : requests) runs.emplace_back(catalog, request);
  BridgeService service(runs);
  std::optional<Store> store;
  if (!options.folder.empty()) {
    store.emplace(options.folder);
    store->plan("serve", planned_cells(requests));
  }
  const sigset_t signals = endings();
  const WithoutSignals held(signals);  // they wait until they are waited for
  HttpServer server(options.host, options.port, service.routes(), BridgeService::refusal,
                    {.body_bytes = service.most_bytes()});
  server.start();
  listening(server.url(), service.models());
  await(signals);
  server.stop();
  Served served;
  if (!store) return served;
  for (ServedRun& run : runs) {
    std::optional<Record> record = run.record();
    if (!record) continue;
    record->provenance.run.command = options.command;
    store->write(*record, std::nullopt);
    served.records.push_back(title_of(run.request()));
  }
  write_sheets(catalog, requests, *store);
  served.remarks = store->remarks();
  return served;
}

}  // namespace isoline::benchmarks
