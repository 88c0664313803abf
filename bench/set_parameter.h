// Parameters of techniques by their command-line spelling.
#pragma once

#include <string>

#include "core/error.h"
#include "techniques/technique.h"

namespace sfumato::bench {

/// Throws `Error` (usage) where the technique has no such parameter or the value is none of it.
inline void set(Technique& technique, const std::string& name, const std::string& value) {
  ParamList params;
  technique.describe(params);
  Param* param = params.find(name);
  if (!param) throw Error(ErrorCode::usage, "no parameter " + name);
  param->set(value);
}

}  // namespace sfumato::bench
