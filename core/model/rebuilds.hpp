// rebuilds.hpp - the functions that make the arrays which a checkpoint does not keep.
#pragma once

#include <cstddef>
#include <string_view>

namespace cdem {

/// When an array is there that a checkpoint does not keep.
enum class Made {
  at_start,      // with the state itself
  after_resume,  // `prepare` calls its function: the begin of a stage may read its result
  with_another,  // by a function of `after_resume`
  in_step,       // every step makes it before anything reads it
};

struct Rebuild {
  const char* name;
  Made made;
};

/// All of them; `prepare` calls the ones of `after_resume` in this order. Data of the last step
/// for a frame, a history or the begin of a stage cannot be made again: a checkpoint keeps them.
inline constexpr Rebuild rebuilds[] = {
    {"list_tiles", Made::at_start},
    {"list_element_corners", Made::at_start},
    {"list_applied", Made::at_start},
    {"list_nodal_means", Made::after_resume},
    {"find_loads_and_supports", Made::after_resume},
    {"list_exposed", Made::after_resume},
    {"list_corners", Made::after_resume},
    {"list_ground", Made::after_resume},
    {"list_lumped", Made::after_resume},
    {"place_predicted_nodes", Made::after_resume},
    {"add_applied", Made::after_resume},
    {"find_awake", Made::after_resume},
    {"list_awake_nodes", Made::with_another},
    {"find_fused_blocks", Made::with_another},
    {"release_bonds", Made::in_step},
    {"update_face_geometry", Made::in_step},
    {"act_of_modules", Made::in_step},
    {"prune_pair_list", Made::in_step},
    {"find_target_faces", Made::in_step},
    {"find_target_edges", Made::in_step},
    {"update_contact_forces", Made::in_step},
    {"update_nodal_means", Made::in_step},
    {"update_element_forces", Made::in_step},
    {"advance_nodes", Made::in_step},
    {"report_elements", Made::in_step},
};

/// One of these functions; a name that is not in the list does not compile.
struct RebuiltBy {
  std::size_t place = 0;

  consteval RebuiltBy(const char* name) {
    while (std::string_view(rebuilds[place].name) != name) ++place;
  }
  constexpr const Rebuild& rebuild() const { return rebuilds[place]; }
};

}  // namespace cdem
