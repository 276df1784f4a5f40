// law_list.hpp - a list of laws that code can go through.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// The largest of some sizes.
template <class... Sizes>
constexpr Index largest_of(Sizes... sizes) {
  Index largest = 0;
  ((largest = Index(sizes) > largest ? Index(sizes) : largest), ...);
  return largest;
}

/// Declarations of a law, as constants: a kernel on a GPU may not call the functions of std::array.
template <template <class> class Law>
inline constexpr Index parameter_count = Index(Law<Real>::parameters.size());
template <template <class> class Law>
inline constexpr Index state_count = Index(Law<Real>::state.size());

/// A list of laws, each a template over the number type that it computes with.
template <template <class> class First, template <class> class... More>
struct LawList {
  static constexpr Index count = 1 + sizeof...(More);
  template <class T>
  using Only = First<T>;  // of a list of one law

  /// Call act.template operator()<Law, number>() for every law.
  template <class Act>
  CDEM_HD static constexpr void for_each(const Act& act) {
    visit<0, Act, First, More...>(act);
  }
  static constexpr Index most_parameters =
      largest_of(parameter_count<First>, parameter_count<More>...);
  static constexpr Index most_state = largest_of(state_count<First>, state_count<More>...);

 private:
#if defined(__CUDACC__)
#pragma nv_exec_check_disable  // of the host's functions the host's code calls this
#endif
  template <Index number, class Act, template <class> class Law, template <class> class... Rest>
  CDEM_HD static constexpr void visit(const Act& act) {
    act.template operator()<Law, number>();
    if constexpr (sizeof...(Rest) > 0) visit<number + 1, Act, Rest...>(act);
  }
};

}  // namespace cdem
