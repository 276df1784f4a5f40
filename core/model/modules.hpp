// modules.hpp - every module, once: a new one is its folder and its name here.
#pragma once

#include "core/bolts/data.hpp"
#include "core/columns/data.hpp"
#include "core/model/module.hpp"
#include "core/surface/data.hpp"
#include "core/water/data.hpp"

namespace cdem {

using Modules = ModuleList<Bolts, Water, Surface, Columns>;

}  // namespace cdem
