// laws.hpp - the list of surface laws.
#pragma once

#include "core/records/law_list.hpp"
#include "core/surface/pressure.hpp"
#include "core/surface/quiet.hpp"
#if defined(CDEM_OWN_SURFACE_LAW)  // a law built in addition to the list
#include CDEM_OWN_SURFACE_HEADER
#endif

namespace cdem {

/// Every surface law; a new one is one header and its name here.
#if defined(CDEM_OWN_SURFACE_LAW)
using SurfaceLaws = LawList<Pressure, Quiet, CDEM_OWN_SURFACE_LAW>;
#else
using SurfaceLaws = LawList<Pressure, Quiet>;
#endif

/// Numbers of the parameters of an entry: whole fours.
inline constexpr Index surface_row = (SurfaceLaws::most_parameters + 3) / 4 * 4;

}  // namespace cdem
