#pragma once

namespace signorini::server {

/// Starts the program anew, with OPENBLAS_CORETYPE set, if BLAS does not use the vector instructions that the
/// processor has: OpenBLAS knows processors by their numbers and takes its oldest kernels, several times
/// slower, for one that is newer than itself; it reads the variable when it is loaded, before main.
void use_vector_instructions(char** argv);

/// Gives every one of so many solves that run at once its share of the cores: the factorisation works in the
/// threads of BLAS where its products are large, and more threads than cores make all of them slower.
void share_cores(int solves);

}  // namespace signorini::server
