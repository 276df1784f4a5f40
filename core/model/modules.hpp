// modules.hpp - every module, once: a new one is its folder and its name here.
#pragma once

#include "core/bolts/data.hpp"
#include "core/model/module.hpp"

namespace cdem {

using Modules = ModuleList<Bolts>;

}  // namespace cdem
