// module_ports.hpp - how, and when in a step, a module acts on nodes.
#pragma once

namespace cdem {

/// How the forces of a module come to nodes.
enum class Port {
  rows,     // between nodes: each adds those of its items, after elements and before contacts
  applied,  // from outside: one sum for each node, after other loads
};
/// When in a step a module acts.
enum class Stage { before_contacts, after_contacts };

}  // namespace cdem
