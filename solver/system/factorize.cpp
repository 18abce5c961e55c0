#include "system/factorize.hpp"

#include "system/cholmod.hpp"
#include "system/multifrontal.hpp"

namespace signorini {

Factor factorize(const ElementSum& matrix, int trailing, Factorization by, Progress& progress) {
  return by == Factorization::cholmod ? cholmod(matrix, trailing, progress)
                                      : multifrontal(matrix, trailing, progress);
}

}  // namespace signorini
