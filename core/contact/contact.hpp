// contact.hpp - front door: all stages of contact.
#pragma once

#include "core/contact/broad_phase/all_pairs_check.hpp"
#include "core/contact/force/force.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/narrow_phase/narrow_phase.hpp"
#include "core/contact/pair_list/inner_list.hpp"
#include "core/contact/pair_list/rebuild.hpp"
