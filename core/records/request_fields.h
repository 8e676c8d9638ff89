// The members of a request, as they stand in a record.
#pragma once

#include "core/records/forms.h"
#include "core/records/request.h"

namespace isoline {

void fields(Like<Component> auto& component, auto& field) {
  field("name", component.name);
  field("options", component.options);
  field("spec", component.spec);
  field.optional("asked", component.asked, R"({"description": "The spec as typed"})");
  field.optional("revision", component.revision, R"({"description": "Of older records"})");
  if constexpr (std::remove_cvref_t<decltype(field)>::kReads)
    component.is_learned = asks_to_learn(component.options);
}

void fields(Like<Budget> auto& budget, auto& field) {
  field("iterations", budget.iterations);
  field("work", Unlimited{budget.work});
  field("seconds", budget.seconds);
  field("target", budget.target);
}

void fields(Like<Request> auto& request, auto& field) {
  field("problem", request.problem);
  field("optimizer", request.optimizer);
  field("seed", request.seed);
  field("budget", request.budget);
  field("threads", request.threads, R"({"minimum": 1})");
  field("rates", request.rates);
}

}  // namespace isoline
