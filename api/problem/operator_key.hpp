#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace signorini::api {

/// The operator_key of a sound problem document: all of it but its title, its solver, its sweep or study and
/// its data, which are the load, and the value, gap or pressure of each condition. A member that this code
/// has never heard of is part of the key.
std::string operator_key(const nlohmann::json& document);

/// The load_key of a problem changed by a sound patch: what that changes of the load, and of the conditions
/// but for their gaps.
std::string load_key(const nlohmann::json& patch);

}  // namespace signorini::api
