/* Stage 3 of the direction grid for AVX-512. */
#define GRID_TEST_FACES grid_test_faces_avx512
#define LANES_AVX512
#include "visibility/grid_faces.h"
