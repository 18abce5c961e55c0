#pragma once

namespace signorini::server {

/// Starts the program anew, with OPENBLAS_CORETYPE set, if BLAS does not use the vector instructions that the
/// processor has: OpenBLAS knows processors by their numbers and takes its oldest kernels, several times
/// slower, for one that is newer than itself; it reads the variable when it is loaded, before main.
void use_vector_instructions(char** argv);

/// So many cores this process may use, one at least: those that it may run on, and of them what the time of
/// its control group is worth, that of a container.
int cores();

/// Of this thread: a solve takes the time that answers leave.
void give_way_to_answers();

/// BLAS has one thread from now on: the solver shares large products with cores that are idle itself
/// (IdleCores), and more threads than cores make all of them slower.
void use_one_thread_of_blas();

}  // namespace signorini::server
