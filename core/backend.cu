#include "core/backend.cpp"  // NOLINT: the same list of launches, compiled for the GPU
