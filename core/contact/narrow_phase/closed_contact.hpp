// closed_contact.hpp - energy that a contact that ended did not give back.
#pragma once

#include "core/contact/geometry/face.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// Energy that the springs of a contact that ended did not give back  [J]. Its two points moved by
/// `displacement` relative to each other in the step that ended it, seen in the frame of one step
/// ago; half
/// the last force did the work. The normal spring gives back until it is free of stress, which is
/// `returned_n` of its penetration: the energy of a contact that opened is lost only as far as its
/// dashpot kept it, but all of it is lost where a vertex slid off a face still under load.
struct DissipatedAtEnd {
  Real friction, dashpot;

  CDEM_HD DissipatedAtEnd(const ContactState& s, Real returned_n, const Frame<Real>& frame,
                          const Vec3<Real>& displacement)
      : friction(s.energy_s - 0.5 * (s.shear1 * dot(frame.t1, displacement) +
                                     s.shear2 * dot(frame.t2, displacement))),
        dashpot(s.energy_n -
                0.5 * s.force_n *
                    min_of(dot(frame.n, displacement), returned_n * max_of(s.penetration, 0.0))) {}
};

}  // namespace cdem
