// The record of a foreign curve: in the form of our own, by their own claims.
#pragma once

#include <string>

#include "benchmarks/import/curve_description.h"
#include "benchmarks/import/foreign_curve.h"
#include "benchmarks/plan/catalog.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

// The files as they were given.
struct ForeignFiles {
  std::string curve, description;  // their texts
  std::string curve_name;          // without its folders
};

// Nothing of it is verified. Where the catalog has the problem its targets are that problem's own,
// by the seed; else those that the description tells. The optimizer's name must be none of the
// catalog's, so that no row mixes runs of ours with claims of others. The same files give the same
// record, whose build is their digest.
Record imported_record(const Catalog& catalog, const CurveDescription& told,
                       const ForeignCurve& curve, const ForeignFiles& files);

}  // namespace isoline::benchmarks
