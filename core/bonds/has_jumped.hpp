// has_jumped.hpp - has a pair moved since it broke?
#pragma once

#include "core/base/views.hpp"

namespace cdem {

struct HasJumped {
  InTable jump;  // [pair], of what is broken  [m]

  template <class I>
  CDEM_HD auto operator()(I item) const {
    return jump.at(0, item) > Number<I>(0.0);
  }
};

}  // namespace cdem
