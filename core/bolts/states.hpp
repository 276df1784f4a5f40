// states.hpp - states of a bolt, of its springs, and of its bars.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Whether a bolt acts. One that is placed takes its lengths, and its pretension, in the next step.
enum class BoltPhase : Flag { waiting, placed, acting, removed };

/// Which part of its law a spring with limits is on.
enum class SliderState : Flag { holds, upper, lower };

/// Whether a bar is whole, has torn, or was cut with excavated rock.
enum class BarState : Flag { whole, ruptured, cut };

}  // namespace cdem
