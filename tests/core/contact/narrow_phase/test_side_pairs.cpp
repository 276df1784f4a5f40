// Sides of two faces as a pair that may touch.
#include "core/contact/geometry/views.hpp"
#include "core/contact/narrow_phase/side_pairs.hpp"
#include "tests/core/scene.hpp"

namespace cdem::test {

TEST_CASE("sides that share a place in the mesh know which ends; bonded ones are no pair") {
  for (const bool bonded : {false, true}) {
    Scene scene;
    scene.bonded = bonded;
    scene.add_box({0, 0, 0}, {1, 1, 1});
    scene.add_box({0, 0, 1}, {1, 1, 1});
    scene.build();
    scene.set_interface({{"cohesion", 1e9}});
    scene.start();
    const FaceColumns faces = face_columns(scene.model, scene.state);
    const auto ends = [&](Index face, Index k) {
      const Index count = faces.vertex_count(face);
      return std::array{faces.vertex(face, k), faces.vertex(face, (k + 1) % count)};
    };
    Index sharing = 0;
    for (Index k = 0; k < 4; ++k)
      for (Index f = 6; f < 12; ++f)
        for (Index j = 0; j < 4; ++j) {
          const Index top = 1;  // of the first box
          Index shared;
          const bool is_pair = pair_sides(faces, top, k, f, j, shared);
          Index expected = 0;
          for (Index a = 0; a < 2; ++a)
            for (Index b = 0; b < 2; ++b)
              if (distance(scene.position(ends(top, k)[a]), scene.position(ends(f, j)[b])) == 0)
                expected |= 1 << (2 * a + b);
          CHECK(is_pair == !(bonded && expected));
          if (!is_pair) continue;
          CHECK(shared == expected);
          sharing += expected != 0;
        }
    CHECK((sharing > 0) == !bonded);
  }
}

}  // namespace cdem::test
